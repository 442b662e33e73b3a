"""Judge claims about other friction laws, and about the lattice of Burridge and Knopoff.

Each function takes the evidence and the id of its claim, and returns the result. A result with
``has_caveat=True`` gives the verdict "reproduced with caveat" if the claim holds in all runs. The
`further` numbers of the result are shown in the table of claims, and sentences quote its
`template_values`.
"""

import numpy as np
import pandas as pd

from .evidence import Evidence, agreed_answers
from .kinds import Qualitative
from .pulse_claims import TWO_WAY

# Rate strengthening divided by the critical one: the most negative and the most positive value of
# the runs in which no block of a pulse would slide back.
STRONGEST_RATES = (-0.5, 0.9)
# The pre-stress at which the front speed under slip weakening is reported.
SLIP_WEAKENING_LEVEL = 0.5


def burridge_knopoff_pulses(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether the lattice of Burridge and Knopoff has pulses under both boundary conditions.

    With leaf springs at least one run should have two pulses, and without them at least one run
    should have one pulse. The caveat is that pulses with leaf springs are wider than one block.
    """
    # All runs count here. Some ruptures die out, and their runs have a flag for this. Other claims
    # leave flagged runs out.
    with_springs = evidence.tables["burridge_knopoff_chain"]
    without_springs = evidence.tables["burridge_knopoff_stress"]
    two_way = with_springs[with_springs["regime"] == TWO_WAY]
    one_way = without_springs[without_springs["regime"].str.startswith("pulse, one-way")]
    # The paper says that pulses are one block wide. Then one block would slide at a time.
    fewest_blocks = two_way["sliding_at_once"].min()
    most_blocks = two_way["sliding_at_once"].max()
    most_without_springs = one_way["sliding_at_once"].max()
    is_wide = bool(fewest_blocks > 1.0)
    regimes = pd.concat([with_springs["regime"], without_springs["regime"]])
    without_pulse = regimes[~regimes.str.startswith("pulse")]
    # Each boundary condition counts as one run. Such a run is undecided if no rupture becomes a
    # pulse.
    decided = [None if pulses.empty else True for pulses in (two_way, one_way)]
    return Qualitative(
        decided=decided,
        has_caveat=is_wide,
        further={
            "fewest blocks that slide at once, with leaf springs": fewest_blocks,
            "most blocks that slide at once, with leaf springs": most_blocks,
            "most blocks that slide at once, without leaf springs": most_without_springs,
        },
        template_values={
            "wide": is_wide,
            "others_stop": bool((without_pulse == "arrested").all() and len(without_pulse)),
            "two_way": len(two_way),
            "with_springs": len(with_springs),
            "one_way": len(one_way),
            "without_springs": len(without_springs),
        },
    )


def pulses_for_many_friction_laws(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether ruptures under other friction laws become pulses.

    A rupture counts as a pulse unless its regime is "crack". Runs in which blocks would slide back
    are left out, and so are ruptures that stop at once.
    """
    # The rows with these two roles are simulated ruptures. Where the column over_critical is 0,
    # friction is constant, which is not another law.
    linear_in_rate = evidence.tables["rate_dependence"].query(
        "role == 'lattice' and over_critical != 0"
    )
    other_laws = evidence.tables["friction_laws"].query("role == 'plane'")
    ruptures = other_laws[other_laws["regime"] != "no rupture"]
    runs = pd.concat([linear_in_rate, ruptures], ignore_index=True)
    slides_back = runs["run_flags"].astype(str).str.contains("reverse_sliding")
    regimes = runs["regime"][~slides_back]
    counts = regimes.value_counts()
    further = {f"ruptures: {regime}": float(count) for regime, count in counts.items()}
    further["runs left out, because blocks would slide backwards"] = float(slides_back.sum())
    stopped = len(other_laws) - len(ruptures)
    further["runs left out, because the fracture energy stops the rupture"] = float(stopped)
    # The caveat is that only some friction laws were tested.
    return Qualitative(decided=regimes != "crack", has_caveat=True, further=further)


def stress_pulse_other_laws(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether a pulse in zero pre-stress decays under rate strengthening, with held stress.

    A pulse decays if its largest velocity falls by more than the tolerance, on the finest and on
    the coarsest lattice. Each value of the rate strengthening counts as one run.
    """
    # The rows with this role are for held stress. They have the largest velocity at several times,
    # for each rate strengthening and spacing dx.
    table = evidence.tables["rate_dependence"].query("role == 'arrest'")
    # Without rate strengthening the pulse is steady from this time on.
    late = table[table["time"] >= 0.1 * table["time"].max()]
    velocities = late.groupby(["rate_strengthening", "dx"])["largest_velocity"]
    lowest_steady_velocities = (1.0 - evidence.tolerance(id)) * velocities.first()
    # One row for each rate strengthening, and one column for each spacing, the finest first.
    decays = (velocities.last() < lowest_steady_velocities).unstack()
    with_strengthening = decays[decays.index > 0.0]
    finest, coarsest = with_strengthening.iloc[:, 0], with_strengthening.iloc[:, -1]
    # The number of steady pulses may differ between lattices. The largest number is shown.
    steady_count = float((~with_strengthening).sum().max())
    words = "coefficients of slip velocity at which a pulse stays steady"
    # The caveat is that only one friction law was tested.
    return Qualitative(
        decided=agreed_answers(finest, coarsest),
        has_caveat=True,
        further={words: steady_count},
    )


def other_laws_change_pulses(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether other laws change width and slip of pulses by more than the tolerance.

    Pulses at the strongest weakening and the strongest strengthening with slip rate
    (STRONGEST_RATES) are compared with pulses at constant friction and the same pre-stress level.
    The sentences of the claim quote `speeds_under_slip_weakening`.
    """
    # The rows with this role are simulated pulses. The column over_critical and STRONGEST_RATES
    # have the rate strengthening divided by the critical one.
    runs = evidence.tables["rate_dependence"].query("role == 'lattice'")
    sizes = runs.set_index(["level", "over_critical"])[["pulse_width", "pulse_slip"]]
    at_constant_friction = sizes.xs(0.0, level="over_critical")
    changes_by_rate = []
    for rate in STRONGEST_RATES:
        ratio = sizes.xs(rate, level="over_critical") / at_constant_friction
        changes_by_rate.append((ratio - 1.0).abs())
    changes = pd.concat(changes_by_rate)
    is_changed = changes > evidence.tolerance(id)
    smallest = changes.min()
    further = {
        "smallest change of the width": float(smallest["pulse_width"]),
        "smallest change of the slip": float(smallest["pulse_slip"]),
    }
    # Each width and each slip counts as one run. The caveat is that only one friction law was
    # tested.
    return Qualitative(
        decided=is_changed.to_numpy().ravel(),
        has_caveat=True,
        further=further,
        template_values=speeds_under_slip_weakening(evidence),
    )


def speeds_under_slip_weakening(evidence: Evidence) -> dict[str, float]:
    """Return exact front speeds under slip weakening, at one pre-stress level.

    The result contains these numbers:

    slowest, fastest : range of these speeds
    level : the pre-stress level, SLIP_WEAKENING_LEVEL
    undamped : front speed at this level by the paper's formula, at constant friction
    """
    level = SLIP_WEAKENING_LEVEL
    rows = evidence.tables["friction_laws"].query("law == 'slip_weakening' and level == @level")
    speeds = rows["exact_speed"].dropna()
    return {
        "slowest": speeds.min(),
        "fastest": speeds.max(),
        "level": level,
        "undamped": 1.0 / np.sqrt(1.0 - level**2),
    }
