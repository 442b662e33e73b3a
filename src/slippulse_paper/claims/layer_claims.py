"""Judge claims about the two-dimensional layer, which the paper averages over its height.

The table `layer` has one row for each run, grid and station. A station is a position on the fault
at which the pulse is measured. Every run was repeated on several grids, and the finest one counts.
A function that judges a claim takes the evidence and the id of the claim, and returns the result.
"""

from collections.abc import Callable
from functools import partial

import numpy as np
import pandas as pd

from . import rules
from .evidence import Evidence, agreed_answers
from .kinds import Approximate, Qualitative
from .rules import Uncertain

# Whether the pulses at a point of `layer_map` are steady, by the outcome of its runs. The other
# outcomes leave this open, because a pulse died early or had not settled.
STEADY_BY_OUTCOME = {"steady": True, "growing": False, "dying": False}
CONVERGED_QUANTITIES = ("speed", "pulse_width", "pulse_slip")
RUN_COLUMNS = ["gamma", "tau0", "weakening", "side"]
# The paper's transition time, pi/sqrt(gamma), divided by the time in which a shear wave runs to the
# top and back, 2 sqrt(2/gamma).
CROSSINGS_OF_TRANSITION = np.pi / np.sqrt(8.0)


def rows_at_station(evidence: Evidence, before_last: int = 0) -> pd.DataFrame:
    """Return the rows of all runs and grids at one station.

    before_last : number of stations between the chosen one and the last one; 0 for the last one
    """
    rows = evidence.tables["layer"].query("part not in ('field', 'step', 'patch')")
    return rows[rows["station"] == rows["station"].max() - before_last]


def finest_rows(rows: pd.DataFrame, part: str, coarser: int = 0) -> pd.DataFrame:
    """Return the rows of one part on the finest grid of each run, or on a coarser grid.

    The index of the rows has the parameters of the run, RUN_COLUMNS.

    rows : rows of all parts and grids, at one station
    coarser : 0 for the finest grid, 1 for the second finest, and so on
    """
    rows = rows[rows["part"] == part].sort_values("cells", kind="stable")
    return rows.groupby(RUN_COLUMNS, sort=False).nth(-1 - coarser).set_index(RUN_COLUMNS)


def change(rows: pd.DataFrame, part: str, quantity: str) -> pd.Series:
    """Return the relative change of a quantity from the second finest to the finest grid."""
    on_finest = finest_rows(rows, part)[quantity]
    on_second_finest = finest_rows(rows, part, coarser=1)[quantity]
    return (on_finest / on_second_finest - 1.0).abs()


def crossing_width(pulses: pd.DataFrame) -> pd.Series:
    """Return the distance behind a front at which shear waves from the top arrive at the fault.

    Shear waves run at the speed sqrt(gamma/2). The waves of a source that moves along the top at
    the speed v have a straight wave front. It meets the fault at the distance sqrt(2 v^2/gamma - 1)
    behind the source.
    """
    gamma = pulses.index.get_level_values("gamma")
    return np.sqrt(2.0 * pulses["speed"] ** 2 / gamma - 1.0)


def layer_regimes(evidence: Evidence, id: str) -> Qualitative:
    """Judge that ruptures under a displacement boundary turn into steady pulses."""
    tolerance = evidence.tolerance(id)
    return on_two_grids(lambda coarser: steady_pulses(evidence, tolerance, coarser))


def layer_regimes_stress(evidence: Evidence, id: str) -> Qualitative:
    """Judge ruptures under a stress boundary.

    In uniform pre-stress, a rupture must be a crack. If there is a barrier on one side, it must
    stop on this side only.
    """
    last_station = rows_at_station(evidence)
    is_crack, is_stopped = (
        on_two_grids(partial(regime, last_station)) for regime in (never_sticks, stops_on_one_side)
    )
    further = {
        "cracks that do not stick, in uniform pre-stress": float(is_crack.counts()["held"]),
        "stopped on one side by a barrier": float(is_stopped.counts()["held"]),
    }
    return Qualitative(decided=[*is_crack.decided, *is_stopped.decided], further=further)


def on_two_grids(holds: Callable[[int], pd.Series]) -> Qualitative:
    """Judge a statement on the two finest grids of each run, which is undecided if they disagree.

    holds : function that returns for each run if the statement holds. Its argument is 0 for the
        finest grid and 1 for the second finest.
    """
    return Qualitative(decided=agreed_answers(holds(0), holds(1)))


def steady_pulses(evidence: Evidence, tolerance: float, coarser: int) -> pd.Series:
    """Return True for each pulse that sticks and is steady.

    It is steady if its speed and slip change by less than the tolerance between the last two
    stations.

    coarser : see `finest_rows`
    """
    pulses = finest_rows(rows_at_station(evidence), "pulse", coarser)
    pulses_before = finest_rows(rows_at_station(evidence, before_last=1), "pulse", coarser)
    compared = ["speed", "pulse_slip"]
    drift = (pulses[compared] / pulses_before[compared] - 1.0).abs()
    # A width above 0 means that the pulse sticks.
    return (drift < tolerance).all(axis=1) & (pulses["pulse_width"] > 0.0)


def never_sticks(last_station: pd.DataFrame, coarser: int) -> pd.Series:
    """Return True for each rupture in uniform pre-stress that never sticks.

    last_station, coarser : see `finest_rows`
    """
    return ~np.isfinite(finest_rows(last_station, "crack", coarser)["first_stick"])


def stops_on_one_side(last_station: pd.DataFrame, coarser: int) -> pd.Series:
    """Return True for each rupture with a barrier on the left that stops there and only there.

    The left front must stop before the balance position, and the blocks must stick. The right front
    must run farther than twice the distance of the balance position.

    last_station, coarser : see `finest_rows`
    """
    ruptures = finest_rows(last_station, "barrier", coarser)
    left, right = ruptures.xs(-1.0, level="side"), ruptures.xs(1.0, level="side")
    balance_distance = left["balance_distance"]
    left_stops = left["end"] > -balance_distance
    right_runs_on = right["end"] > 2.0 * balance_distance
    return left_stops & right_runs_on & np.isfinite(left["first_stick"])


def layer_width(evidence: Evidence, id: str) -> Approximate:
    """Compare the pulse width in two dimensions with the paper's formula."""
    rows = rows_at_station(evidence)
    pulses = finest_rows(rows, "pulse")
    ratio = pulses["pulse_width"] / pulses["paper_pulse_width"]
    deviations = (ratio - 1.0).abs()
    # The uncertainty is the change from the second finest to the finest grid.
    uncertainty = float((change(rows, "pulse", "pulse_width") * ratio).median())
    speed_ratio = pulses["speed"] / pulses["paper_speed"]
    slip_ratio = pulses["pulse_slip"] / pulses["paper_pulse_slip"]
    energies = pulses["fracture_energy"]
    return Approximate(
        tolerance=evidence.tolerance(id),
        deviations=deviations.to_numpy(),
        median=Uncertain(float(deviations.median()), uncertainty),
        ratio=Uncertain(float(ratio.median()), uncertainty),
        failing=rules.BEYOND,
        further={
            "median in the plane, divided by the formula: speed": float(speed_ratio.median()),
            "median in the plane, divided by the formula: pulse slip": float(slip_ratio.median()),
            "narrowest in the plane, divided by the formula": float(ratio.min()),
            "widest in the plane": float(ratio.max()),
        },
        template_values={
            "least": float(energies.min()),
            "most": float(energies.max()),
            "spread": largest_spread(pulses),
            "largest_change": float(change(rows, "pulse", "pulse_width").max()),
        },
    )


def layer_stability(evidence: Evidence, id: str) -> Qualitative:
    """Judge that pulses are steady if the fracture energy is below the energy that is released.

    Fracture energies are divided by the largest energy that the layer can release, so the limit is
    1. Above the limit no pulse can exist. The claim has a caveat if a pulse that enters a very
    different pre-stress has not become steady at the last station.
    """
    points = evidence.tables["layer_map"]
    brittle = points[points["fracture_energy"] < 1.0]
    tough = points[points["fracture_energy"] > 1.0]
    # These outcomes are reported even if no point has them.
    further = {f"points that are {outcome}": 0.0 for outcome in ("steady", "growing", "dying")}
    for outcome, count in points["outcome"].value_counts().items():
        further[f"points that are {outcome}"] = float(count)
    tough_and_dying = (tough["outcome"] == "dying").sum()
    further["dying with more fracture energy than can be released"] = float(tough_and_dying)
    decided = [STEADY_BY_OUTCOME.get(outcome) for outcome in brittle["outcome"]]
    step = across_a_step(evidence)
    differences = [step["upwards_difference"], step["downwards_difference"]]
    return Qualitative(
        decided=decided,
        condition=not max(differences) < evidence.tolerance(id),
        further=further,
        template_values=step | {"elasticity_ratios": float(brittle["gamma"].nunique())},
    )


def largest_spread(pulses: pd.DataFrame) -> float:
    """Return the largest relative difference between widths if only the fracture energy differs.

    This is the largest width divided by the smallest, minus 1.
    """
    widths = pulses["pulse_width"].groupby(level=["gamma", "tau0"]).agg(["max", "min", "count"])
    with_several_energies = widths[widths["count"] > 1]
    spread = with_several_energies["max"] / with_several_energies["min"] - 1.0
    return float(spread.max())


def layer_in_plane(evidence: Evidence) -> dict[str, float]:
    """Return the numbers for the section on the premise, which averages the layer over its height.

    Most of them are the smallest and the largest value of a quantity (NAME_low and NAME_high),
    which are defined in `pulse_quantities`. Others are changes from the second finest to the finest
    grid (NAME_change), and final slips from `across_a_step`.
    """
    rows = rows_at_station(evidence)
    pulses = finest_rows(rows, "pulse")
    varied = with_varied_energy(pulses)
    thinnest = with_smallest_gamma(varied)
    patch = finest_rows(evidence.tables["layer"], "patch")
    numbers = {
        "pulses": float(len(pulses)),
        "level": float(varied.index.get_level_values("tau0")[0]),
        "crossings": CROSSINGS_OF_TRANSITION,
        "spread": largest_spread(varied),
        "formula_speed": float(varied["paper_speed"].max()),
        "thinnest_formula": float(thinnest["paper_pulse_width"].max()),
    }
    quantities = pulse_quantities(pulses)
    quantities["first_stick"] = patch["first_stick"] / patch["strip_first_stick"]
    for name, values in quantities.items():
        numbers |= {f"{name}_low": float(values.min()), f"{name}_high": float(values.max())}
    for quantity in CONVERGED_QUANTITIES:
        numbers[f"{quantity}_change"] = float(change(rows, "pulse", quantity).max())
    return numbers | across_a_step(evidence)


def with_varied_energy(pulses: pd.DataFrame) -> pd.DataFrame:
    """Return the pulses that differ only in gamma and fracture energy.

    They have the level of pre-stress that most pulses have.
    """
    levels = pulses.reset_index()["tau0"]
    most_frequent_level = float(levels.mode().iloc[0])
    return pulses.xs(most_frequent_level, level="tau0", drop_level=False)


def with_smallest_gamma(pulses: pd.DataFrame) -> pd.DataFrame:
    """Return the pulses with the smallest gamma, which are the widest."""
    gamma = pulses.index.get_level_values("gamma")
    return pulses.xs(gamma.min(), level="gamma")


def pulse_quantities(pulses: pd.DataFrame) -> dict[str, pd.Series | pd.Index]:
    """Return quantities of pulses by name, each with one value for each pulse.

    width, slip : compared with the paper's formulas
    brittle_... : for pulses with the smallest fracture energy
    crossing : pulse width divided by `crossing_width`
    sliding : time for which a point slides, divided by the time in which a shear wave crosses the
        layer
    slip_over_bound : slip divided by the largest slip that the energy balance allows
    waves : fraction of the released energy that leaves as waves
    """
    varied = with_varied_energy(pulses)
    brittle = varied[varied["fracture_energy"] == varied["fracture_energy"].min()]
    gamma = pulses.index.get_level_values("gamma")
    # A slip of s times the formula releases the static energy 4 s (1 - s), in units of G_0.
    relative_slip = pulses["pulse_slip"] / pulses["paper_pulse_slip"]
    released_energy = 4.0 * relative_slip * (1.0 - relative_slip)
    return {
        "gamma": gamma,
        "tau0": pulses.index.get_level_values("tau0"),
        "energy": varied["fracture_energy"],
        "speed": varied["speed"],
        "brittle_speed": brittle["speed"],
        "width": varied["paper_pulse_width"] / varied["pulse_width"],
        "slip": varied["pulse_slip"] / varied["paper_pulse_slip"],
        "brittle_slip": brittle["pulse_slip"] / brittle["paper_pulse_slip"],
        "crossing": pulses["pulse_width"] / crossing_width(pulses),
        "sliding": pulses["pulse_width"] / pulses["speed"] * np.sqrt(0.5 * gamma),
        "thinnest_width": with_smallest_gamma(varied)["pulse_width"],
        "slip_over_bound": pulses["pulse_slip"] / pulses["balance_pulse_slip"],
        "waves": 1.0 - pulses["fracture_energy"] / released_energy,
    }


def across_a_step(evidence: Evidence) -> dict[str, float]:
    """Return the final slip of pulses that enter another pre-stress, and of uniform runs.

    upwards, downwards : final slip of the pulse that enters a higher or a lower pre-stress
    uniform_higher, uniform_lower : final slip in these two levels of pre-stress from the start
    upwards_difference, downwards_difference : relative difference between the two slips
    """
    rows = evidence.tables["layer"].query("part == 'step'")
    rows = rows[rows["cells"] == rows["cells"].max()].sort_values("station")
    # The slip at the last station, by the level before the step and the level beyond it.
    final_slip = rows.groupby(["before", "tau0"])["pulse_slip"].last()
    low, high = float(rows["tau0"].min()), float(rows["tau0"].max())
    upwards, uniform_higher = float(final_slip[low, high]), float(final_slip[high, high])
    downwards, uniform_lower = float(final_slip[high, low]), float(final_slip[low, low])
    return {
        "lower": low,
        "higher": high,
        "upwards": upwards,
        "downwards": downwards,
        "uniform_lower": uniform_lower,
        "uniform_higher": uniform_higher,
        "upwards_difference": abs(upwards / uniform_higher - 1.0),
        "downwards_difference": abs(downwards / uniform_lower - 1.0),
    }
