"""Claims about other friction laws, and about the lattice of Burridge and Knopoff."""

import numpy as np
import pandas as pd

from ..data.numerals import number
from .evidence import Evidence, agreeing
from .kinds import Qualitative
from .pulses import TWO_WAY

# The strongest rate dependences with pulses in which no block would slide back, over the critical
# one.
STRONGEST = (-0.5, 0.9)
SIZES = ("width", "slip")


def burridge_knopoff_pulses(evidence: Evidence, id: str) -> Qualitative:
    """Some run has pulses both ways with leaf springs, and some a pulse one way without."""
    # The tables have runs that are flagged since they died out, too.
    chain, spike = (evidence.tables[f"burridge_knopoff_{name}"] for name in ("chain", "stress"))
    two_way = chain[chain["regime"] == TWO_WAY]["sliding_at_once"]
    one_way = spike[spike["regime"].str.startswith("pulse, one-way")]["sliding_at_once"]
    fewest, most = two_way.min(), two_way.max()
    # In a pulse a block wide one block slides at once.
    wide = bool(fewest > 1.0)
    why = f"There are pulses in {len(two_way)} of {len(chain)} runs with and {len(one_way)} of "
    why += f"{len(spike)} runs without leaf springs, the others arrest; they are {number(fewest)} "
    why += f"to {number(most)} blocks wide; the paper's figure, a sketch, shows one."
    further = {"fewest blocks at once": fewest, "most": most, "without leaf springs": one_way.max()}
    decided = [len(runs) > 0 or None for runs in (two_way, one_way)]
    return Qualitative(decided=decided, condition=wide, further=further, why=why if wide else "")


def pulses_for_many_friction_laws(evidence: Evidence, id: str) -> Qualitative:
    """A rupture is a pulse under each other law, unless blocks would slide back."""
    linear = evidence.tables["rate_dependence"].query("role == 'lattice' and over_critical != 0")
    bounded = evidence.tables["friction_laws"].query("role == 'plane'")
    ruptures = bounded[bounded["regime"] != "no rupture"]
    runs = pd.concat([linear, ruptures], ignore_index=True)
    outside = runs["run_flags"].astype(str).str.contains("reverse_sliding")
    kinds = runs["regime"][~outside]
    further = {f"ruptures: {kind}": float(count) for kind, count in kinds.value_counts().items()}
    further["left out, since blocks would slide back"] = float(outside.sum())
    further["left out, since fracture energy stops them"] = float(len(bounded) - len(ruptures))
    why = "Tested are friction linear in slip rate, bounded laws of it, and slip weakening."
    return Qualitative(decided=kinds != "crack", condition=True, further=further, why=why)


def stress_pulse_other_laws(evidence: Evidence, id: str) -> Qualitative:
    """With rate strengthening and the stress held, the pulse at zero pre-stress decays."""
    table = evidence.tables["rate_dependence"].query("role == 'arrest'")
    # From then on the pulse without such a law is steady.
    late = table[table["time"] >= 0.1 * table["time"].max()]
    falls = late.groupby(["rate_strengthening", "dx"])["largest_velocity"].agg(["first", "last"])
    decays = (falls["last"] < (1.0 - evidence.tolerance(id)) * falls["first"]).unstack()
    laws = decays[decays.index > 0.0]
    words = "laws, by their strengthening, that leave a steady pulse"
    why = "Tested is one family of laws, friction that strengthens linearly with slip rate."
    answers = agreeing(laws.iloc[:, 0], laws.iloc[:, -1])
    further = {words: float((~laws).sum().max())}
    return Qualitative(decided=answers, condition=True, further=further, why=why)


def other_laws_change_pulses(evidence: Evidence, id: str) -> Qualitative:
    """Width and slip at the strongest dependences with pulses differ from those without one."""
    runs = evidence.tables["rate_dependence"].query("role == 'lattice'")
    runs = runs.set_index(["level", "over_critical"])[[f"pulse_{size}" for size in SIZES]]
    independent = runs.xs(0.0, level=1)
    changes = [(runs.xs(factor, level=1) / independent - 1.0).abs() for factor in STRONGEST]
    change = pd.concat(changes)
    held = (change > evidence.tolerance(id)).to_numpy().ravel()
    least = change.min()
    further = {f"smallest change of the {size}": float(least[f"pulse_{size}"]) for size in SIZES}
    laws = evidence.tables["friction_laws"].query("law == 'slip_weakening' and level == 0.5")
    speeds = laws["exact_speed"].dropna()
    undamped = 1.0 / np.sqrt(1.0 - 0.5**2)
    why = "The runs are of friction linear in slip rate, which leaves the front speed as it is."
    why += rf" Slip weakening changes it too: at $\tau_0$ = 0.5 it is {number(speeds.min())} to "
    why += f"{number(speeds.max())}, where the formula has {number(undamped, 4)} "
    why += "(figure study_friction_laws)."
    return Qualitative(decided=held, condition=True, further=further, why=why)
