"""Judge claims about other friction laws, and about the lattice of Burridge and Knopoff.

Each function takes the evidence and the id of its claim, and returns the result.
"""

import numpy as np
import pandas as pd

from .evidence import Evidence, agreed_answers
from .kinds import Qualitative
from .pulse_claims import TWO_WAY

# Rate dependences divided by the critical one. Stronger ones of either sign would let blocks slide
# back in pulses.
STRONGEST_RATES = (-0.5, 0.9)
PULSE_SIZES = ("width", "slip")
# The pre-stress at which the front speed under slip weakening is reported.
SLIP_WEAKENING_LEVEL = 0.5


def burridge_knopoff_pulses(evidence: Evidence, id: str) -> Qualitative:
    """Find runs with two pulses (with leaf springs) and runs with one pulse (without)."""
    # These tables also contain runs that are flagged because the rupture died out.
    chain, spike = (evidence.tables[f"burridge_knopoff_{name}"] for name in ("chain", "stress"))
    two_way = chain[chain["regime"] == TWO_WAY]["sliding_at_once"]
    one_way = spike[spike["regime"].str.startswith("pulse, one-way")]["sliding_at_once"]
    fewest, most = two_way.min(), two_way.max()
    # In a pulse that is one block wide, one block slides at a time.
    wide = bool(fewest > 1.0)
    template_values = {"wide": wide, "two_way": len(two_way), "with_springs": len(chain)}
    template_values |= {"one_way": len(one_way), "without_springs": len(spike)}
    further = {"fewest blocks at once": fewest, "most": most, "without leaf springs": one_way.max()}
    decided = [len(runs) > 0 or None for runs in (two_way, one_way)]
    return Qualitative(
        decided=decided, condition=wide, further=further, template_values=template_values
    )


def pulses_for_many_friction_laws(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether ruptures under each other law are pulses; skip runs that would slide back."""
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
    """Judge whether a pulse at zero pre-stress decays under rate strengthening, stress held."""
    table = evidence.tables["rate_dependence"].query("role == 'arrest'")
    # From this time on the pulse without rate strengthening is steady.
    late = table[table["time"] >= 0.1 * table["time"].max()]
    falls = late.groupby(["rate_strengthening", "dx"])["largest_velocity"].agg(["first", "last"])
    decays = (falls["last"] < (1.0 - evidence.tolerance(id)) * falls["first"]).unstack()
    laws = decays[decays.index > 0.0]
    words = "laws, by their strengthening, that leave a steady pulse"
    answers = agreed_answers(laws.iloc[:, 0], laws.iloc[:, -1])
    further = {words: float((~laws).sum().max())}
    return Qualitative(decided=answers, condition=True, further=further)


def other_laws_change_pulses(evidence: Evidence, id: str) -> Qualitative:
    """Compare width and slip at the strongest rate dependences with those at constant friction."""
    runs = evidence.tables["rate_dependence"].query("role == 'lattice'")
    runs = runs.set_index(["level", "over_critical"])[[f"pulse_{size}" for size in PULSE_SIZES]]
    independent = runs.xs(0.0, level=1)
    changes = [(runs.xs(factor, level=1) / independent - 1.0).abs() for factor in STRONGEST_RATES]
    change = pd.concat(changes)
    held = (change > evidence.tolerance(id)).to_numpy().ravel()
    least = change.min()
    further = {
        f"smallest change of the {size}": float(least[f"pulse_{size}"]) for size in PULSE_SIZES
    }
    laws = evidence.tables["friction_laws"].query(
        f"law == 'slip_weakening' and level == {SLIP_WEAKENING_LEVEL}"
    )
    speeds = laws["exact_speed"].dropna()
    template_values = {
        "slowest": speeds.min(),
        "fastest": speeds.max(),
        "level": SLIP_WEAKENING_LEVEL,
    }
    template_values["undamped"] = 1.0 / np.sqrt(1.0 - SLIP_WEAKENING_LEVEL**2)
    return Qualitative(
        decided=held, condition=True, further=further, template_values=template_values
    )
