"""Judge claims about the two-dimensional layer, which the paper averages over its height.

The table `layer` has one row for each run, grid and station. A station is a position on the fault
at which the pulse is measured. Every run was repeated on several grids, and the finest one counts.
The column part names a group of runs; `studies.layer.table` describes all of them. The part far has
pulses of the part pulse, and one of the part step, followed farther. A function that judges a claim
takes the evidence and the id of the claim, and returns the result. The `further` numbers of the
result are shown in the table of claims, and sentences quote its `template_values`. With
``has_caveat``, the verdict is at most "reproduced with caveat".
"""

from collections.abc import Callable

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
# Columns that identify a run within its part. The side is LEFT or RIGHT.
RUN_COLUMNS = ["gamma", "tau0", "weakening", "coupling", "side"]
LEFT, RIGHT = -1.0, 1.0
# Stations, counted from the last one.
LAST, SECOND_LAST = 0, 1
THIRD_LAST = 2
# Pulses with a smaller fracture energy, divided by the energy that the layer releases, are brittle.
BRITTLE_ENERGY = 0.4
# The paper's transition time, pi/sqrt(gamma), divided by the time in which a shear wave runs to the
# top and back, 2 sqrt(2/gamma).
CROSSINGS_OF_TRANSITION = np.pi / np.sqrt(8.0)
# The zone in which the strength falls is resolved if at least this number of cells is in its length
# gamma d_c.
RESOLVED_CELLS = 2.0


def rows_at_station(evidence: Evidence, station: int) -> pd.DataFrame:
    """Return the rows of all runs and grids at one station: LAST, SECOND_LAST or THIRD_LAST."""
    rows = evidence.tables["layer"].query("part not in ('field', 'step', 'patch')")
    return rows[rows["station"] == rows["station"].max() - station]


def finest_rows(rows: pd.DataFrame, part: str, coarser: int = 0) -> pd.DataFrame:
    """Return the rows of one part on the finest grid of each run, or on a coarser grid.

    The index of the rows has the parameters of the run, RUN_COLUMNS.

    rows : rows of all parts and grids, at one station
    coarser : 0 for the finest grid, 1 for the second finest, and so on
    """
    rows = rows[rows["part"] == part].sort_values("cells", kind="stable")
    return rows.groupby(RUN_COLUMNS, sort=False).nth(-1 - coarser).set_index(RUN_COLUMNS)


def change_by_refinement(rows: pd.DataFrame, part: str, quantity: str) -> pd.Series:
    """Return the relative change of a quantity from the second finest to the finest grid.

    There is one value for each run of the part.
    """
    on_finest = finest_rows(rows, part)[quantity]
    on_second_finest = finest_rows(rows, part, coarser=1)[quantity]
    return (on_finest / on_second_finest - 1.0).abs()


def sliding_in_crossings(pulses: pd.DataFrame) -> pd.Series:
    """Return the sliding time divided by the crossing time.

    The crossing time is the time from the arrival of the front at a point of the fault to the
    arrival of shear waves from the top (`crossing_width`). Both times are widths divided by the
    front speed, which cancels.
    """
    return pulses["pulse_width"] / crossing_width(pulses)


def crossing_width(pulses: pd.DataFrame) -> pd.Series:
    """Return the distance behind a front at which shear waves from the top arrive at the fault.

    Where the longitudinal wave of the front meets the top, it sends shear waves down, so that their
    source moves along the top with the front. Shear waves run at the speed sqrt(gamma/2). If the
    source has the speed v, they have a straight wave front, which meets the fault at the distance
    sqrt(2 v^2/gamma - 1) behind the source.
    """
    gamma = pulses.index.get_level_values("gamma")
    return np.sqrt(2.0 * pulses["speed"] ** 2 / gamma - 1.0)


def layer_regimes(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether ruptures under a displacement boundary turn into steady pulses.

    The pulses of the part pulse are judged at the positions of the part far, where most of them
    were followed. The template values are the numbers of `numbers_on_splits`.
    """
    tolerance = evidence.tolerance(id)
    pulses = finest_rows(rows_at_station(evidence, LAST), "pulse")
    decided = steady_on_two_grids(evidence, "far", tolerance)
    # The part far has one more pulse, which is not among the judged ones. It only shows how a pulse
    # of the part step goes on.
    decided = decided[decided.index.isin(pulses.index)]
    values = numbers_on_splits(evidence, tolerance)
    return Qualitative(decided=list(decided), template_values=values)


def layer_pressure(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether pulses are also steady if the strength depends on the normal stress.

    The column coupling has the factor by which the strength depends on this stress. The pulses that
    run to the right and to the left then differ, and each counts.

    The template values are:

    steady_right, steady_left : number of steady pulses that run to each side
    steady_to, failed_from : largest coupling of a steady pulse, smallest of one that is not steady
    weakest, strongest : range of the coupling
    split_low, split_high : range of the positions at which pulses split
    """
    decided = steady_on_two_grids(evidence, "coupled", evidence.tolerance(id))
    coupled = finest_rows(rows_at_station(evidence, LAST), "coupled")
    # A pulse that is undecided (None) is in neither group. The index has the parameters of the
    # pulses, which become columns.
    steady = coupled[decided.eq(True)].reset_index()
    failed = coupled[decided.eq(False)].reset_index()
    coupled = coupled.reset_index()
    return Qualitative(
        decided=list(decided),
        template_values={
            "steady_right": float((steady["side"] == RIGHT).sum()),
            "steady_left": float((steady["side"] == LEFT).sum()),
            "steady_to": float(steady["coupling"].max()),
            "failed_from": float(failed["coupling"].min()),
            "weakest": float(coupled["coupling"].min()),
            "strongest": float(coupled["coupling"].max()),
            "split_low": float(coupled["split_position"].min()),
            "split_high": float(coupled["split_position"].max()),
        },
    )


def layer_free_top(evidence: Evidence, id: str) -> Approximate:
    """Judge whether a point also slides for one crossing time if the top of the layer is free.

    A free top may rise. The crossing time is the time from the arrival of the front at a point of
    the fault to the arrival of shear waves from the top (`crossing_width`). The part free has the
    pulses of layers with such a top.
    """
    rows = rows_at_station(evidence, LAST)
    # The sliding time of each pulse with a free top, divided by its crossing time, should be 1.
    crossings = sliding_in_crossings(finest_rows(rows, "free"))
    deviations = (crossings - 1.0).abs()
    # The sliding time is as uncertain as the pulse width, which changes from the second finest to
    # the finest grid. The uncertainty is the largest of these changes, in crossing times.
    uncertainty = float((change_by_refinement(rows, "free", "pulse_width") * crossings).max())
    return Approximate(
        tolerance=evidence.tolerance(id),
        deviations=deviations.to_numpy(),
        median=Uncertain(float(deviations.median()), uncertainty),
        ratio=Uncertain(float(crossings.median()), uncertainty),
        further=ranges_of_sliding_times(rows),
    )


def ranges_of_sliding_times(rows: pd.DataFrame) -> dict[str, float]:
    """Return the smallest and largest sliding times, each with words for the table of claims.

    The parts free and held have the same pulses, with a top that may rise and with one that cannot.
    """
    in_crossings = "sliding time divided by the time for a shear front to cross the layer"
    free_over_held = "sliding time with free top divided by that with held top"
    ratios_by_words = {
        f"{in_crossings}, top free to rise": sliding_in_crossings(finest_rows(rows, "free")),
        f"{in_crossings}, top held": sliding_in_crossings(finest_rows(rows, "held")),
        free_over_held: times_longer_with_free_top(rows),
    }
    ranges = {}
    for words, values in ratios_by_words.items():
        ranges[f"{words}: smallest"] = float(values.min())
        ranges[f"{words}: largest"] = float(values.max())
    return ranges


def times_longer_with_free_top(rows: pd.DataFrame) -> pd.Series:
    """Return the sliding time with a top that may rise, divided by the one with a held top."""
    free, held = (finest_rows(rows, part) for part in ("free", "held"))
    return (free["pulse_width"] / free["speed"]) / (held["pulse_width"] / held["speed"])


def layer_regimes_stress(evidence: Evidence, id: str) -> Qualitative:
    """Judge ruptures under a stress boundary.

    In uniform pre-stress, a rupture must be a crack. If there is a barrier on one side, it must
    stop on this side and become a pulse on the other. Barriers are on the left.

    The template values are:

    stop_low, stop_high : range of the distance from x = 0 to the stopped left front, divided by the
        balance distance
    stick_change : largest relative change of the time of the first stick by refinement
    """
    is_crack = on_two_grids(lambda coarser: never_sticks(evidence, coarser))
    is_stopped = on_two_grids(lambda coarser: stops_on_one_side(evidence, coarser))
    rows = rows_at_station(evidence, LAST)
    left_fronts = finest_rows(rows, "barrier").xs(LEFT, level="side")
    # The final front position on the left is negative.
    relative_path = -left_fronts["end"] / left_fronts["balance_distance"]
    first_stick_change = change_by_refinement(rows, "barrier", "first_stick")
    further = {
        "cracks that do not stick, in uniform pre-stress": float(is_crack.counts()["held"]),
        "ruptures that a barrier stops on one side": float(is_stopped.counts()["held"]),
    }
    return Qualitative(
        decided=[*is_crack.decided, *is_stopped.decided],
        further=further,
        template_values={
            "stop_low": float(relative_path.min()),
            "stop_high": float(relative_path.max()),
            "stick_change": float(first_stick_change.max()),
        },
    )


def on_two_grids(holds: Callable[[int], pd.Series]) -> Qualitative:
    """Judge a statement on the two finest grids of each run, which is undecided if they disagree.

    holds : function that returns for each run whether the statement holds. Its argument is 0 for
        the finest grid and 1 for the second finest.
    """
    return Qualitative(decided=agreed_answers(holds(0), holds(1)))


def steady_on_two_grids(evidence: Evidence, part: str, tolerance: float) -> pd.Series:
    """Return whether each pulse of a part is steady on its two finest grids.

    A pulse is steady if speed and slip change by less than the tolerance between the last two
    stations, and if no point slides again behind it. The answer is None if the two finest grids
    disagree. It is also None if the pulse splits on any grid, because the position at which it
    splits depends on the grid, so that the split may be a numerical error.

    part : far, damped or coupled
    """
    at_last = rows_at_station(evidence, LAST)
    at_second_last = rows_at_station(evidence, SECOND_LAST)
    compared = ["speed", "pulse_slip"]
    is_steady_on_grids = []
    for coarser in (0, 1):
        pulses = finest_rows(at_last, part, coarser)
        pulses_before = finest_rows(at_second_last, part, coarser)
        change = (pulses[compared] / pulses_before[compared] - 1.0).abs()
        is_steady = (change < tolerance).all(axis=1) & (pulses["sliding_again"] == 0.0)
        is_steady_on_grids.append(is_steady)
    on_finest, on_second_finest = is_steady_on_grids
    never_splits = number_of_grids_with_split(at_last, part).reindex(on_finest.index) == 0
    is_decided = (on_finest == on_second_finest) & never_splits
    return on_finest.astype(object).where(is_decided, None)


def number_of_grids_with_split(rows: pd.DataFrame, part: str) -> pd.Series:
    """Return on how many grids each pulse of a part splits.

    rows : rows of all parts and grids, at one station
    """
    # The position is NaN on a grid on which the pulse does not split.
    return rows[rows["part"] == part].groupby(RUN_COLUMNS)["split_position"].count()


def followed_pulses(evidence: Evidence, tolerance: float) -> pd.DataFrame:
    """Return the pulses of the part far at the last station, with columns on how they split.

    The added columns are:

    split_at, coarse_split_at, third_split_at : position at which the pulse splits on its finest,
        second finest and third finest grid, divided by the factor by which pulses are wider than
        those at the largest gamma; NaN if the pulse does not split, or if there is no such grid
    splits_only_on_finest : True if the pulse splits on its finest grid, and on no other one
    cells_in_weakening : number of cells in gamma d_c, the length over which the strength falls
    is_narrow : True at the largest gamma, at which pulses are narrowest
    is_steady : True if `steady_on_two_grids` is True at this tolerance
    """
    rows = rows_at_station(evidence, LAST)
    followed = finest_rows(rows, "far")
    gamma = followed.index.get_level_values("gamma")
    weakening = followed.index.get_level_values("weakening")
    # The last station is farther away by the factor by which pulses are wider.
    stretch = followed["sample_position"] / followed["sample_position"].min()
    # Positions on the finest, the second finest and the third finest grid. A pulse without such a
    # grid gets NaN.
    split_at = [
        finest_rows(rows, "far", coarser)["split_position"].reindex(followed.index) / stretch
        for coarser in (0, 1, 2)
    ]
    splits_on_one_grid = number_of_grids_with_split(rows, "far").reindex(followed.index) == 1
    return followed.assign(
        split_at=split_at[0],
        coarse_split_at=split_at[1],
        third_split_at=split_at[2],
        splits_only_on_finest=splits_on_one_grid & split_at[0].notna(),
        cells_in_weakening=gamma * weakening * followed["cells"],
        is_narrow=gamma == gamma.max(),
        is_steady=steady_on_two_grids(evidence, "far", tolerance).eq(True),
    )


def numbers_on_splits(evidence: Evidence, tolerance: float) -> dict[str, float]:
    """Return how many pulses split, where they split, and how well the grid resolves the others.

    The result contains these numbers:

    pulses, near_distance : number of pulses of the part pulse, and the distance to which they were
        followed at the largest gamma
    followed, distance : number of these pulses that are also in the part far, and the distance to
        which they were followed there, at the largest gamma
    split : number of pulses of the part far that split on the finest grid
    damped, damped_steady : number of pulses that were followed with damping, and of steady ones

    The other numbers are explained in the functions that are called.

    tolerance : largest relative change of speed and slip of a steady pulse
    """
    pulses = finest_rows(rows_at_station(evidence, LAST), "pulse")
    followed = followed_pulses(evidence, tolerance)
    is_counted = followed.index.isin(pulses.index)
    # The parameters of the pulses become columns.
    counted, not_counted = followed[is_counted].reset_index(), followed[~is_counted]
    split = counted[counted["split_at"].notna()]
    damped = steady_on_two_grids(evidence, "damped", tolerance)
    numbers = {
        "pulses": float(len(pulses)),
        # Pulses are followed least far at the largest gamma.
        "near_distance": float(pulses["sample_position"].min()),
        "followed": float(len(counted)),
        "distance": float(followed["sample_position"].min()),
        "split": float(len(split)),
        **split_of_step_pulse(not_counted),
        "damped": float(len(damped)),
        "damped_steady": float(damped.eq(True).sum()),
    }
    steady = counted[counted["is_steady"]]
    return numbers | ranges_of_splits(split) | poorly_resolved(steady)


def split_of_step_pulse(step: pd.DataFrame) -> dict[str, float]:
    """Return numbers on how the pulse of the part step splits, which the part far follows farther.

    All other pulses of the part far are those of the part pulse. The result contains these numbers:

    step_energy : its fracture energy
    step_split : position at which it splits on its finest grid
    step_only_on_finest : 1 if it splits on no other grid, and 0 otherwise

    step : the rows of `followed_pulses` with this pulse: one row, or none if the pulse was not
        followed farther
    """
    # The minimum of one value is this value. It is NaN if there is no row.
    return {
        "step_energy": float(step["fracture_energy"].min()),
        "step_split": float(step["split_at"].min()),
        "step_only_on_finest": float(step["splits_only_on_finest"].all()),
    }


def ranges_of_splits(split: pd.DataFrame) -> dict[str, float]:
    """Return at which gamma and fracture energies pulses split, and in which ranges of positions.

    Pulses at the largest gamma are narrow, and the others are wide.

    The result contains these numbers:

    narrow_gamma, narrow_energy : largest gamma and fracture energy of narrow pulses that split
    split_low, split_high : range of the positions at which narrow pulses split, on the finest grid
    coarse_split_low, coarse_split_high : the same range on the second finest grid
    third_split_low, third_split_high : the same range on the third finest grid
    wide_gamma, wide_energy, wide_split_low, wide_split_high : the same numbers of wide pulses, on
        the finest grid
    wide_only_on_finest : 1 if these wide pulses split on no other grid, and 0 otherwise

    split : rows of `followed_pulses` with the pulses that split on the finest grid
    """
    narrow, wide = split[split["is_narrow"]], split[~split["is_narrow"]]
    return {
        "narrow_gamma": float(narrow["gamma"].max()),
        "narrow_energy": float(narrow["fracture_energy"].max()),
        "split_low": float(narrow["split_at"].min()),
        "split_high": float(narrow["split_at"].max()),
        "coarse_split_low": float(narrow["coarse_split_at"].min()),
        "coarse_split_high": float(narrow["coarse_split_at"].max()),
        "third_split_low": float(narrow["third_split_at"].min()),
        "third_split_high": float(narrow["third_split_at"].max()),
        "wide_gamma": float(wide["gamma"].max()),
        "wide_energy": float(wide["fracture_energy"].max()),
        "wide_split_low": float(wide["split_at"].min()),
        "wide_split_high": float(wide["split_at"].max()),
        "wide_only_on_finest": float(wide["splits_only_on_finest"].all()),
    }


def poorly_resolved(steady: pd.DataFrame) -> dict[str, float]:
    """Return numbers on the steady pulses for which the finest grid is rather coarse.

    Such pulses have less than RESOLVED_CELLS cells in gamma d_c, over which the strength falls.

    The result contains these numbers:

    resolved_cells : the constant RESOLVED_CELLS
    unresolved : number of these pulses
    unresolved_gamma, unresolved_energy : their largest gamma and fracture energy
    unresolved_cells : their smallest number of cells in gamma d_c

    steady : rows of `followed_pulses` with the steady pulses
    """
    unresolved = steady[steady["cells_in_weakening"] < RESOLVED_CELLS]
    return {
        "resolved_cells": RESOLVED_CELLS,
        "unresolved": float(len(unresolved)),
        "unresolved_gamma": float(unresolved["gamma"].max()),
        "unresolved_energy": float(unresolved["fracture_energy"].max()),
        "unresolved_cells": float(unresolved["cells_in_weakening"].min()),
    }


def never_sticks(evidence: Evidence, coarser: int) -> pd.Series:
    """Return for each rupture in uniform pre-stress whether it never sticks.

    coarser : 0 for the finest grid, 1 for the second finest
    """
    cracks = finest_rows(rows_at_station(evidence, LAST), "crack", coarser)
    return ~np.isfinite(cracks["first_stick"])


def stops_on_one_side(evidence: Evidence, coarser: int) -> pd.Series:
    """Return for each rupture with a barrier on the left whether it stops there.

    The left front must stop before the balance position. On the right there must be a pulse, which
    must have passed the second last station by the end. When the run ends, the front is not far
    beyond the last station, so that a wide pulse may not have passed that one completely.

    coarser : 0 for the finest grid, 1 for the second finest
    """
    at_last = finest_rows(rows_at_station(evidence, LAST), "barrier", coarser)
    at_second_last = finest_rows(rows_at_station(evidence, SECOND_LAST), "barrier", coarser)
    left, right = at_last.xs(LEFT, level="side"), at_second_last.xs(RIGHT, level="side")
    # The final position of the left front is negative.
    has_stopped = left["end"] > -left["balance_distance"]
    # A pulse has no width at a station that it has not passed.
    return has_stopped & np.isfinite(right["pulse_width"])


def layer_width(evidence: Evidence, id: str) -> Approximate:
    """Compare the pulse width in two dimensions with the paper's formula.

    The template values are:

    least, most : range of the fracture energies
    one_dimension_low, one_dimension_high : range of the width divided by the width in one dimension
        with the same friction and with damping
    """
    rows = rows_at_station(evidence, LAST)
    pulses = finest_rows(rows, "pulse")
    ratio = pulses["pulse_width"] / pulses["paper_pulse_width"]
    deviations = (ratio - 1.0).abs()
    # The uncertainty is the largest change of the ratio from the second finest to the finest grid.
    uncertainty = float((change_by_refinement(rows, "pulse", "pulse_width") * ratio).max())
    speed_ratio = pulses["speed"] / pulses["paper_speed"]
    slip_ratio = pulses["pulse_slip"] / pulses["paper_pulse_slip"]
    energies = pulses["fracture_energy"]
    ratio_to_one_dimension = pulses["pulse_width"] / pulses["damped_pulse_width"]
    return Approximate(
        tolerance=evidence.tolerance(id),
        deviations=deviations.to_numpy(),
        median=Uncertain(float(deviations.median()), uncertainty),
        ratio=Uncertain(float(ratio.median()), uncertainty),
        # The paper makes no claim about two dimensions.
        failing=rules.BEYOND,
        further={
            "front speed divided by the formula: median": float(speed_ratio.median()),
            "pulse slip divided by the formula: median": float(slip_ratio.median()),
            "pulse width divided by the formula: smallest": float(ratio.min()),
            "pulse width divided by the formula: largest": float(ratio.max()),
        },
        template_values={
            "least": float(energies.min()),
            "most": float(energies.max()),
            "one_dimension_low": float(ratio_to_one_dimension.min()),
            "one_dimension_high": float(ratio_to_one_dimension.max()),
        },
    )


def layer_stability(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether pulses are steady if the fracture energy is below the released energy.

    Fracture energies are divided by the largest energy that the layer can release. So no pulse can
    exist above 1, and each point of the map in `layer_map` below 1 counts as one run. An outcome
    counts if two grids agree on it. The claim has a caveat if a pulse that enters a very different
    pre-stress has not become steady at the last station, or if pulses of a point split farther away
    (see `map_numbers`).
    """
    points = evidence.tables["layer_map"]
    agrees = points["outcome"] == points["coarse_outcome"]
    points = points.assign(outcome=points["outcome"].where(agrees, "grids differ"))
    brittle = points[points["fracture_energy"] < 1.0]
    # The answer is None for outcomes that leave it open.
    decided = [STEADY_BY_OUTCOME.get(outcome) for outcome in brittle["outcome"]]
    step = across_a_step(evidence)
    differences = [step["upwards_difference"], step["downwards_difference"]]
    has_settled = max(differences) < evidence.tolerance(id)
    on_map = map_numbers(evidence)
    template_values = step | on_map
    # Number of values of gamma with points that are judged.
    template_values["elasticity_ratios"] = float(brittle["gamma"].nunique())
    template_values["has_settled"] = has_settled
    return Qualitative(
        decided=decided,
        has_caveat=not has_settled or on_map["splitting_points"] > 0.0,
        further=points_by_outcome(points),
        template_values=template_values,
    )


def points_by_outcome(points: pd.DataFrame) -> dict[str, float]:
    """Return how many points of `layer_map` have each outcome, with words for the table of claims.

    Also return at how many points the pulse dies because the layer cannot release enough energy.

    points : rows of the map, whose column outcome has "grids differ" if the two grids disagree
    """
    # The first three outcomes are reported even if no point has them.
    counts = {"steady": 0, "growing": 0, "dying": 0} | dict(points["outcome"].value_counts())
    by_words = {
        f"points of the map with the outcome {name}": float(count) for name, count in counts.items()
    }
    # Fracture energies are divided by the largest energy that the layer can release.
    dies_by_energy = (points["outcome"] == "dying") & (points["fracture_energy"] > 1.0)
    words = "points where the pulse dies, with more fracture energy than the layer can release"
    return by_words | {words: float(dies_by_energy.sum())}


def map_numbers(evidence: Evidence) -> dict[str, float]:
    """Return the conditions of the runs of `layer_map`, and how many of its pulses would split.

    The result contains these numbers:

    level_below, level_above, level : levels of the pre-stress before a step, and the level that all
        pulses enter at the step
    step_position, last_position : where the step is, and up to where pulses are followed, in H at
        the largest gamma
    coarse_cells, cells : cells over the height on the two grids
    splitting_points, splitting_from : number of points whose pulses would split farther away, and
        smallest distance at which they would (`split_distances`)
    """
    points = evidence.tables["layer_map"]
    at_largest_gamma = points.loc[points["gamma"].idxmax()]
    columns = ("level_below", "level_above", "step_position", "last_position", "coarse_cells")
    conditions = {name: float(at_largest_gamma[name]) for name in (*columns, "cells")}
    distances = split_distances(evidence)
    return conditions | {
        "level": float(at_largest_gamma["tau0"]),
        "splitting_points": float(len(distances)),
        "splitting_from": min(distances, default=np.nan),
    }


def split_distances(evidence: Evidence) -> list[float]:
    """Return for each point of `layer_map` whose pulses would split the distance at which they do.

    A point is a pair of gamma and fracture energy. Pulses of the part far are followed farther than
    those of the map. We assume that a pulse of the map would split if a pulse of the part far with
    the same gamma and pre-stress splits on any grid, and if its fracture energy is equal or larger,
    because pulses split more easily at a smaller one. The smallest distance of such splits counts.
    """
    points = evidence.tables["layer_map"]
    far = rows_at_station(evidence, LAST).query("part == 'far'").dropna(subset=["split_position"])
    distances = []
    # At a larger fracture energy than 1, the energy that the layer can release, no pulse can exist.
    for point in points[points["fracture_energy"] < 1.0].itertuples():
        is_alike = np.isclose(far["gamma"], point.gamma) & np.isclose(far["tau0"], point.tau0)
        split = far[is_alike & (far["fracture_energy"] >= point.fracture_energy)]
        if len(split):
            # At a smaller gamma pulses are wider, and the step is farther away by the same factor.
            # Divided by it, distances at different gamma can be compared.
            stretch = point.step_position / points["step_position"].min()
            distances.append(float(split["split_position"].min()) / stretch)
    return distances


def layer_in_plane(evidence: Evidence) -> dict[str, float]:
    """Return the numbers for the section on the layer in two dimensions.

    Most of them come from the functions that are called, which explain them. The others are:

    QUANTITY_low, QUANTITY_high : smallest and largest value of a quantity over all its pulses
    QUANTITY_change : largest relative change by refinement, from the second finest to the finest
        grid
    map_NAME : a number of `map_numbers`
    crossings, brittle_energy : the constants CROSSINGS_OF_TRANSITION and BRITTLE_ENERGY
    crossing_high : longest time for which a point slides, divided by the crossing time
        (`sliding_in_crossings`)
    """
    rows = rows_at_station(evidence, LAST)
    pulses = finest_rows(rows, "pulse")
    numbers = {
        "crossings": CROSSINGS_OF_TRANSITION,
        "brittle_energy": BRITTLE_ENERGY,
        "level_spread": spread_with_level(pulses),
        "crossing_high": float(sliding_in_crossings(pulses).max()),
    } | formula_numbers(pulses)
    quantities = {
        **quantities_of_all_pulses(pulses),
        **quantities_at_one_level(pulses),
        **quantities_in_one_dimension(pulses),
        # If the top may rise (part free), a point slides for these times. The first is divided by
        # the crossing time, and the second by the time for which it slides if the top is held.
        "free": sliding_in_crossings(finest_rows(rows, "free")),
        "longer": times_longer_with_free_top(rows),
    }
    for name, values in quantities.items():
        numbers |= {f"{name}_low": float(values.min()), f"{name}_high": float(values.max())}
    for quantity in CONVERGED_QUANTITIES:
        numbers[f"{quantity}_change"] = float(change_by_refinement(rows, "pulse", quantity).max())
    numbers |= {f"map_{name}": value for name, value in map_numbers(evidence).items()}
    return numbers | largest_speeds(evidence) | far_numbers(evidence) | across_a_step(evidence)


def formula_numbers(pulses: pd.DataFrame) -> dict[str, float]:
    """Return numbers by the paper's formulas, at the pre-stress level that most pulses have.

    The result contains these numbers:

    level : this level
    formula_speed : front speed by the formula
    gamma_low, thinnest_formula : smallest gamma, and pulse width by the formula at this gamma
    """
    at_level = with_varied_energy(pulses)
    # All these pulses have the same level, so the formula gives them the same front speed. The
    # width by the formula depends on the level and gamma only.
    return {
        "level": float(at_level.index.get_level_values("tau0")[0]),
        "formula_speed": float(at_level["paper_speed"].max()),
        "gamma_low": float(at_level.index.get_level_values("gamma").min()),
        "thinnest_formula": float(with_smallest_gamma(at_level)["paper_pulse_width"].max()),
    }


def with_varied_energy(pulses: pd.DataFrame) -> pd.DataFrame:
    """Return the pulses that differ only in gamma and fracture energy.

    All of them have the level of pre-stress that most pulses have.
    """
    levels = pulses.reset_index()["tau0"]
    most_frequent_level = float(levels.mode().iloc[0])
    return pulses.xs(most_frequent_level, level="tau0", drop_level=False)


def with_smallest_gamma(pulses: pd.DataFrame) -> pd.DataFrame:
    """Return the pulses with the smallest gamma, which are the widest."""
    gamma = pulses.index.get_level_values("gamma")
    return pulses.xs(gamma.min(), level="gamma")


def quantities_of_all_pulses(pulses: pd.DataFrame) -> dict[str, pd.Series]:
    """Return quantities of pulses by name, each with one value for each pulse.

    The quantities are:

    wider : pulse width divided by the width in one dimension with the same friction and with
        damping
    sliding : time for which a point slides, divided by H/c_s, where c_s is the shear wave speed
    slip_over_bound : slip divided by the largest slip that the energy balance allows
    waves : fraction of the released energy that leaves as waves
    """
    gamma = pulses.index.get_level_values("gamma")
    # If s is the slip divided by that of the formula, the layer releases the energy 4 s (1 - s).
    # The unit is the largest energy that it can release, as for the fracture energy.
    relative_slip = pulses["pulse_slip"] / pulses["paper_pulse_slip"]
    released_energy = 4.0 * relative_slip * (1.0 - relative_slip)
    return {
        "wider": pulses["pulse_width"] / pulses["damped_pulse_width"],
        # In these units c_s = sqrt(gamma/2) and H = 1.
        "sliding": pulses["pulse_width"] / pulses["speed"] * np.sqrt(0.5 * gamma),
        "slip_over_bound": pulses["pulse_slip"] / pulses["balance_pulse_slip"],
        "waves": 1.0 - pulses["fracture_energy"] / released_energy,
    }


def quantities_at_one_level(pulses: pd.DataFrame) -> dict[str, pd.Series]:
    """Return quantities of the pulses that differ only in gamma and fracture energy.

    The quantities are:

    width : width by the paper's formula divided by the pulse width
    thinnest_width : pulse width at the smallest gamma, at which the layer is thinnest compared with
        the pulses
    brittle_slip : slip divided by the slip by the paper's formula, at the smallest fracture energy
    brittle_crossing : time for which a point slides, divided by the crossing time
        (`sliding_in_crossings`), at fracture energies below BRITTLE_ENERGY
    """
    at_level = with_varied_energy(pulses)
    energy = at_level["fracture_energy"]
    most_brittle = at_level[energy == energy.min()]
    return {
        "width": at_level["paper_pulse_width"] / at_level["pulse_width"],
        "thinnest_width": with_smallest_gamma(at_level)["pulse_width"],
        "brittle_slip": most_brittle["pulse_slip"] / most_brittle["paper_pulse_slip"],
        "brittle_crossing": sliding_in_crossings(at_level[energy < BRITTLE_ENERGY]),
    }


def quantities_in_one_dimension(pulses: pd.DataFrame) -> dict[str, pd.Series]:
    """Return quantities of pulses in one dimension with the same friction, and with damping.

    The quantities are those of the pulses that differ only in gamma and fracture energy.

    The quantities are:

    line_speed : front speed
    line_width, line_slip : width and slip, divided by those of the paper's formulas
    """
    at_level = with_varied_energy(pulses)
    return {
        "line_speed": at_level["damped_speed"],
        "line_width": at_level["damped_pulse_width"] / at_level["paper_pulse_width"],
        "line_slip": at_level["damped_pulse_slip"] / at_level["paper_pulse_slip"],
    }


def largest_speeds(evidence: Evidence) -> dict[str, float]:
    """Return the speeds of the fastest pulse on its coarsest and on its finest grid.

    The two speeds show that a speed slightly above that of the fastest wave is an error of the
    grid. Also return the largest speed of all pulses with damping (damped_speed), on the finest
    grids. Speeds are measured at the last station.
    """
    at_station = rows_at_station(evidence, LAST)
    rows = at_station.query("part == 'pulse'")
    fastest = rows.loc[rows["speed"].idxmax()]
    is_fastest_run = (rows[RUN_COLUMNS] == fastest[RUN_COLUMNS]).all(axis=1)
    by_grid = rows[is_fastest_run].sort_values("cells")
    coarsest, finest = by_grid.iloc[0], by_grid.iloc[-1]
    return {
        "coarse_cells": float(coarsest["cells"]),
        "coarse_speed": float(coarsest["speed"]),
        "fine_cells": float(finest["cells"]),
        "fine_speed": float(finest["speed"]),
        "damped_speed": float(finest_rows(at_station, "damped")["speed"].max()),
    }


def far_numbers(evidence: Evidence) -> dict[str, float]:
    """Return numbers on the pulses of the part far, which were followed farther.

    The result contains the numbers of `numbers_on_splits`: how many of these pulses split, and
    where.

    The other numbers are:

    from_near_slip : largest relative change of the slip between the first and the last station, of
        pulses that do not split
    drawn_split : position at which the pulse that a figure shows splits
    """
    numbers = numbers_on_splits(evidence, evidence.tolerance("layer_regimes"))
    numbers["drawn_split"] = split_of_drawn_pulse(evidence)
    # With an infinite tolerance, a pulse counts as steady if it does not split and if no point
    # slides again behind it.
    is_whole = steady_on_two_grids(evidence, "far", tolerance=np.inf).eq(True)
    # The part far has three stations.
    first, last = (
        finest_rows(rows_at_station(evidence, station), "far")["pulse_slip"]
        for station in (THIRD_LAST, LAST)
    )
    slip_change = (last / first - 1.0).abs()
    numbers["from_near_slip"] = float(slip_change[is_whole].max())
    return numbers


def split_of_drawn_pulse(evidence: Evidence) -> float:
    """Return where the pulse that a figure shows splits on its finest grid, in units of H.

    NaN if it does not split on this grid.
    """
    # The figure shows the part field. The part far has the same pulse, which is followed farther.
    drawn = evidence.tables["layer"].query("part == 'field'").iloc[0]
    far = finest_rows(rows_at_station(evidence, LAST), "far").reset_index()
    parameters = ["gamma", "tau0", "weakening"]
    drawn_parameters = drawn[parameters].to_numpy(float)
    is_drawn = np.isclose(far[parameters].to_numpy(float), drawn_parameters).all(axis=1)
    return float(far["split_position"][is_drawn].max())


def spread_with_level(pulses: pd.DataFrame) -> float:
    """Return the largest factor by which pulse widths differ only because of the pre-stress level.

    Pulses with the same gamma and fracture energy are compared.
    """
    gammas = pulses.index.get_level_values("gamma")
    # Fracture energies that are equal may differ by rounding.
    energies = pulses["fracture_energy"].round(6)
    same_otherwise = pulses["pulse_width"].groupby([gammas, energies])
    return float((same_otherwise.max() / same_otherwise.min()).max())


def across_a_step(evidence: Evidence) -> dict[str, float]:
    """Return how much the slip of a pulse that enters another pre-stress differs from steady slip.

    The slip at the last station is compared with that of a pulse that is in the same pre-stress
    from the start. The relative difference is given for the grid on which it is larger.

    The result contains these numbers:

    lower, higher : the two levels of the pre-stress
    upwards_difference : difference for the pulse that enters the higher level
    downwards_difference : difference for the pulse that enters the lower level
    """
    rows = evidence.tables["layer"].query("part == 'step'").sort_values("station")
    low, high = float(rows["tau0"].min()), float(rows["tau0"].max())
    # The slip at the last station, with one row for each grid, and one column for each pair of
    # levels before and beyond the step. In a uniform run both levels are equal.
    final_slip = rows.groupby(["cells", "before", "tau0"])["pulse_slip"].last()
    slips = final_slip.unstack(["before", "tau0"])
    return {
        "lower": low,
        "higher": high,
        "upwards_difference": float((slips[low, high] / slips[high, high] - 1.0).abs().max()),
        "downwards_difference": float((slips[high, low] / slips[low, low] - 1.0).abs().max()),
    }
