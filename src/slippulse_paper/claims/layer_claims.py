"""Judge claims about the two-dimensional layer, which the paper averages over its height.

The table `layer` has one row for each run, grid and station; a station is a position at which the
pulse is measured. Every run was made on several grids, and its finest grid is used.
"""

import numpy as np
import pandas as pd

from . import rules
from .evidence import Evidence
from .kinds import Approximate, Qualitative

# Whether the pulses of a point of the map are steady. All other outcomes leave it undecided,
# because a pulse from below or from above was not tested or had not settled.
STEADY_BY_OUTCOME = {"steady": True, "growing": False, "dying": False}
CONVERGED_QUANTITIES = ("speed", "pulse_width", "pulse_slip")
RUN_COLUMNS = ["gamma", "tau0", "weakening", "side"]
# The paper's transition time, pi/sqrt(gamma), divided by the travel time of a shear wave to the top
# and back, 2 sqrt(2/gamma).
CROSSINGS_OF_TRANSITION = np.pi / np.sqrt(8.0)


def rows_at_station(evidence: Evidence, before_last: int = 0) -> pd.DataFrame:
    """Return the rows of all runs and grids at the last station.

    A station is a position on the fault at which a pulse is measured.

    before_last : number of stations before the last one, to choose an earlier station
    """
    rows = evidence.tables["layer"].query("part not in ('field', 'step', 'patch')")
    return rows[rows["station"] == rows["station"].max() - before_last]


def finest_rows(rows: pd.DataFrame, part: str, coarser: int = 0) -> pd.DataFrame:
    """Return the rows of one part on the finest grid of each run, or on a coarser one.

    The index has the parameters of the run, RUN_COLUMNS.

    rows : rows of all parts and grids, at one station
    coarser : number of grids by which the chosen grid is coarser than the finest
    """
    rows = rows[rows["part"] == part].sort_values("cells", kind="stable")
    return rows.groupby(RUN_COLUMNS, sort=False).nth(-1 - coarser).set_index(RUN_COLUMNS)


def change(rows: pd.DataFrame, part: str, quantity: str) -> pd.Series:
    """Return the relative change of a quantity from the second finest to the finest grid."""
    on_finest = finest_rows(rows, part)[quantity]
    on_second_finest = finest_rows(rows, part, coarser=1)[quantity]
    return (on_finest / on_second_finest - 1.0).abs()


def crossing_width(pulses: pd.DataFrame) -> pd.Series:
    """Return the distance that a front runs while its shear front comes down from the top.

    Shear waves have the speed sqrt(gamma/2). The shear front of a source that moves along the top
    at the speed v is a straight line. It meets the fault behind the source, at the distance
    sqrt(2 v^2/gamma - 1).
    """
    gamma = pulses.index.get_level_values("gamma")
    return np.sqrt(2.0 * pulses["speed"] ** 2 / gamma - 1.0)


def layer_regimes(evidence: Evidence, id: str) -> Qualitative:
    """Judge the regimes of the layer, in three groups of runs.

    Under a displacement boundary ruptures must be steady pulses. Under a stress boundary a rupture
    must be a crack in uniform pre-stress, and must stop on the side of a barrier, and there only.
    """
    last_station = rows_at_station(evidence)
    pulses = finest_rows(last_station, "pulse")
    pulses_before = finest_rows(rows_at_station(evidence, before_last=1), "pulse")
    compared = ["speed", "pulse_slip"]
    drift = (pulses[compared] / pulses_before[compared] - 1.0).abs()
    is_steady = (drift < evidence.tolerance(id)).all(axis=1)
    # A width above 0 means that the pulse sticks.
    is_steady_pulse = is_steady & (pulses["pulse_width"] > 0.0)

    never_sticks = ~np.isfinite(finest_rows(last_station, "crack")["first_stick"])

    barriers = finest_rows(last_station, "barrier")
    left, right = (barriers.xs(side, level="side") for side in (-1.0, 1.0))
    balance_distance = left["balance_distance"]
    left_arrests = left["end"] > -balance_distance
    right_runs_on = right["end"] > 2.0 * balance_distance
    is_stopped = left_arrests & right_runs_on & np.isfinite(left["first_stick"])
    further = {
        "pulses that stick and settle, displacement held": float(is_steady_pulse.sum()),
        "cracks that do not stick, stress held": float(never_sticks.sum()),
        "stopped on one side by a barrier, stress held": float(is_stopped.sum()),
    }
    return Qualitative(decided=[*is_steady_pulse, *never_sticks, *is_stopped], further=further)


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
        median=(float(deviations.median()), uncertainty),
        ratio=(float(ratio.median()), uncertainty),
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
        },
    )


def layer_stability(evidence: Evidence, id: str) -> Qualitative:
    """Judge that pulses are steady if the fracture energy is below the energy that is released.

    Fracture energies are divided by the energy that the layer releases, so that the limit is 1.
    """
    points = evidence.tables["layer_map"]
    brittle = points[points["fracture_energy"] < 1.0]
    tough = points[points["fracture_energy"] > 1.0]
    # These outcomes are reported even if no point has them.
    further = {f"points that are {outcome}": 0.0 for outcome in ("steady", "growing", "dying")}
    for outcome, count in points["outcome"].value_counts().items():
        further[f"points that are {outcome}"] = float(count)
    tough_and_dying = (tough["outcome"] == "dying").sum()
    further["dying with more fracture energy than is released"] = float(tough_and_dying)
    decided = [STEADY_BY_OUTCOME.get(outcome) for outcome in brittle["outcome"]]
    return Qualitative(decided=decided, further=further)


def largest_spread(pulses: pd.DataFrame) -> float:
    """Return how much the fracture energy changes the pulse width, as a relative change.

    It is the largest width divided by the smallest, minus 1, for pulses that differ only in
    fracture energy.
    """
    widths = pulses["pulse_width"].groupby(level=["gamma", "tau0"]).agg(["max", "min", "count"])
    with_several_energies = widths[widths["count"] > 1]
    spread = with_several_energies["max"] / with_several_energies["min"] - 1.0
    return float(spread.max())


def layer_in_plane(evidence: Evidence) -> dict[str, float]:
    """Return the numbers for the section on the premise, which averages the layer over its height.

    Most are ranges, with the smallest (low) and the largest value (high) in all pulses, in those
    with varied fracture energy, or in those with the smallest fracture energy (brittle). Width and
    slip are compared with the paper's formulas.
    """
    rows = rows_at_station(evidence)
    pulses = finest_rows(rows, "pulse")
    # The fracture energy is varied at the level that most pulses have.
    level = float(pulses.reset_index()["tau0"].mode().iloc[0])
    varied = pulses.xs(level, level="tau0", drop_level=False)
    brittle = varied[varied["fracture_energy"] == varied["fracture_energy"].min()]
    patch = finest_rows(evidence.tables["layer"], "patch")
    ranges = {
        "gamma": pulses.index.get_level_values("gamma"),
        "tau0": pulses.index.get_level_values("tau0"),
        "energy": varied["fracture_energy"],
        "speed": varied["speed"],
        "brittle_speed": brittle["speed"],
        "width": varied["paper_pulse_width"] / varied["pulse_width"],
        "slip": varied["pulse_slip"] / varied["paper_pulse_slip"],
        "brittle_slip": brittle["pulse_slip"] / brittle["paper_pulse_slip"],
        "crossing": pulses["pulse_width"] / crossing_width(pulses),
        "first_stick": patch["first_stick"] / patch["strip_first_stick"],
    }
    numbers = {
        "pulses": float(len(pulses)),
        "level": level,
        "crossings": CROSSINGS_OF_TRANSITION,
        "spread": largest_spread(varied),
        "formula_speed": float(varied["paper_speed"].max()),
    }
    for name, values in ranges.items():
        numbers |= {f"{name}_low": float(values.min()), f"{name}_high": float(values.max())}
    for quantity in CONVERGED_QUANTITIES:
        numbers[f"{quantity}_change"] = float(change(rows, "pulse", quantity).max())
    return numbers | across_a_step(evidence)


def across_a_step(evidence: Evidence) -> dict[str, float]:
    """Return the final slip of pulses that enter another pre-stress, and of uniform runs."""
    rows = evidence.tables["layer"].query("part == 'step'")
    rows = rows[rows["cells"] == rows["cells"].max()].sort_values("station")
    # The slip at the last station, by the level before the step and the level beyond it.
    final_slip = rows.groupby(["before", "tau0"])["pulse_slip"].last()
    low, high = float(rows["tau0"].min()), float(rows["tau0"].max())
    return {
        "lower": low,
        "higher": high,
        "upwards": float(final_slip[low, high]),
        "downwards": float(final_slip[high, low]),
        "uniform_lower": float(final_slip[low, low]),
        "uniform_higher": float(final_slip[high, high]),
    }
