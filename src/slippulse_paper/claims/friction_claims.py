"""Claims about other friction laws, and about the lattice of Burridge and Knopoff."""

import numpy as np
import pandas as pd

from .evidence import Evidence, agreeing
from .kinds import Qualitative
from .pulse_claims import TWO_WAY

# The strongest rate dependences with pulses in which no block would slide back, over the critical
# one.
STRONGEST = (-0.5, 0.9)
SIZES = ("width", "slip")
# The pre-stress at which the front speed under slip weakening is told.
LEVEL = 0.5


def burridge_knopoff_pulses(evidence: Evidence, id: str) -> Qualitative:
    """Some run has pulses both ways with leaf springs, and some a pulse one way without."""
    # The tables have runs that are flagged since they died out, too.
    chain, spike = (evidence.tables[f"burridge_knopoff_{name}"] for name in ("chain", "stress"))
    two_way = chain[chain["regime"] == TWO_WAY]["sliding_at_once"]
    one_way = spike[spike["regime"].str.startswith("pulse, one-way")]["sliding_at_once"]
    fewest, most = two_way.min(), two_way.max()
    # In a pulse a block wide one block slides at once.
    wide = bool(fewest > 1.0)
    told = {"wide": wide, "two_way": len(two_way), "with_springs": len(chain)}
    told |= {"one_way": len(one_way), "without_springs": len(spike)}
    further = {"fewest blocks at once": fewest, "most": most, "without leaf springs": one_way.max()}
    decided = [len(runs) > 0 or None for runs in (two_way, one_way)]
    return Qualitative(decided=decided, condition=wide, further=further, told=told)


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
    return Qualitative(decided=kinds != "crack", condition=True, further=further)


def stress_pulse_other_laws(evidence: Evidence, id: str) -> Qualitative:
    """With rate strengthening and the stress held, the pulse at zero pre-stress decays."""
    table = evidence.tables["rate_dependence"].query("role == 'arrest'")
    # From then on the pulse without such a law is steady.
    late = table[table["time"] >= 0.1 * table["time"].max()]
    falls = late.groupby(["rate_strengthening", "dx"])["largest_velocity"].agg(["first", "last"])
    decays = (falls["last"] < (1.0 - evidence.tolerance(id)) * falls["first"]).unstack()
    laws = decays[decays.index > 0.0]
    words = "laws, by their strengthening, that leave a steady pulse"
    answers = agreeing(laws.iloc[:, 0], laws.iloc[:, -1])
    further = {words: float((~laws).sum().max())}
    return Qualitative(decided=answers, condition=True, further=further)


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
    laws = evidence.tables["friction_laws"].query(f"law == 'slip_weakening' and level == {LEVEL}")
    speeds = laws["exact_speed"].dropna()
    told = {"slowest": speeds.min(), "fastest": speeds.max(), "level": LEVEL}
    told["undamped"] = 1.0 / np.sqrt(1.0 - LEVEL**2)
    return Qualitative(decided=held, condition=True, further=further, told=told)
