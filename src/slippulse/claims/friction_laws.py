"""Claims about other friction laws, and about the lattice of Burridge and Knopoff.

Other laws are tested as far as friction linear in slip rate tests them.
"""

import pandas as pd

from ..data.numerals import number
from .evidence import Evidence
from .kinds import Existence, Qualitative
from .pulses import TWO_WAY

# A pulse a block wide has this many that slide at once.
ABOUT_ONE = 1.0
# Within this relative distance from the exact line the regime of a lattice is not decided.
DECIDED = 0.08
# The strongest rate dependences that still have pulses, over the critical one.
STRONGEST = (-0.9, 0.9)


def burridge_knopoff_pulses(evidence: Evidence, id: str) -> Existence:
    """There are pulses both ways with leaf springs, and a pulse one way without.

    The caveat is on their width, which is in blocks.
    """
    chain = evidence.finest("burridge_knopoff_chain")
    spike = evidence.finest("burridge_knopoff_stress")
    two_way = chain[chain["regime"] == TWO_WAY]["sliding_at_once"]
    one_way = spike[spike["regime"].str.startswith("pulse, one-way")]["sliding_at_once"]
    fewest, most = two_way.min(), two_way.max()
    cases = {"with leaf springs": len(two_way), "without": len(one_way)}
    wide = all(cases.values()) and fewest > ABOUT_ONE
    why = (
        "The two kinds of pulse are reproduced, their width is not: "
        f"{number(fewest)} to {number(most)} blocks."
    )
    further = {"fewest blocks at once": fewest, "most": most, "without leaf springs": one_way.max()}
    return Existence.shown(cases, further, condition=wide, why=why if wide else "")


def lattices_with_rate(evidence: Evidence) -> pd.DataFrame:
    """Runs with friction that depends on slip rate."""
    return evidence.tables["rate_dependence"].query("role == 'lattice'")


def pulses_for_many_friction_laws(evidence: Evidence, id: str) -> Qualitative:
    """At each pre-stress there are pulses with friction that weakens or strengthens with rate."""
    runs = lattices_with_rate(evidence)
    dependent = runs[runs["over_critical"] != 0.0]
    pulses = dependent["regime"] == "pulse"
    strengthening = dependent["over_critical"] > 0.0
    exist = pulses.groupby([dependent["level"], strengthening]).any()
    limit = runs["rate_strengthening"] / runs["over_critical"] / runs["gamma"] ** 0.5
    where = "where they end, over the square root of gamma, at the {} pre-stress".format
    further = {where("lowest"): float(limit.min()), where("highest"): float(limit.max())}
    return Qualitative.counted(exist, condition=True, further=further)


def pulses_whatever_friction(evidence: Evidence, id: str) -> Qualitative:
    """The rupture is a pulse at every rate dependence.

    Lattices next to the exact line, between pulses and other regimes, decide nothing.
    """
    runs = lattices_with_rate(evidence)
    over_critical, pulse = runs["over_critical"].abs(), runs["regime"] == "pulse"
    as_predicted = (over_critical < 1.0) == pulse
    near = (over_critical - 1.0).abs() < DECIDED
    further = {
        "runs on the side of the exact line that it says": float(as_predicted.sum()),
        "others, all next to the line": float((near & ~as_predicted).sum()),
        "others, away from it": float((~near & ~as_predicted).sum()),
    }
    return Qualitative.counted(pulse.astype(object).mask(near, None), further=further)


def other_laws_change_pulses(evidence: Evidence, id: str) -> Qualitative:
    """Width and slip at the strongest dependences with pulses differ from those without one."""
    runs = lattices_with_rate(evidence).set_index(["level", "over_critical"])
    runs = runs[["pulse_width", "pulse_slip"]]
    independent = runs.xs(0.0, level=1)
    changes = [(runs.xs(factor, level=1) / independent - 1.0).abs() for factor in STRONGEST]
    change = pd.concat(changes)
    held = (change > evidence.tolerance(id)).to_numpy().ravel()
    further = {
        f"smallest change of the {name.removeprefix('pulse_')}": float(least)
        for name, least in change.min().items()
    }
    return Qualitative.counted(held, condition=True, further=further)
