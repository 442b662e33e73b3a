"""Judge claims about the two-dimensional layer, which the paper averages over its height.

The table `layer` has one row for each run, grid and station; a station is a position at which the
pulse is measured. Every run was made on several grids, and its finest grid is used.
"""

import numpy as np
import pandas as pd

from . import rules
from .evidence import Evidence
from .kinds import Approximate, Qualitative

CONVERGED_QUANTITIES = ("speed", "pulse_width", "pulse_slip")
RUN_COLUMNS = ["gamma", "tau0", "weakening", "side"]
# The paper's transition time, pi/sqrt(gamma), divided by the travel time of a shear wave to the top
# and back, 2 sqrt(2/gamma).
CROSSINGS_OF_TRANSITION = np.pi / np.sqrt(8.0)


def rows_at_station(evidence: Evidence, step: int = 0) -> pd.DataFrame:
    """Return the rows of all grids at the last station, or ``step`` stations before it."""
    runs = evidence.tables["layer"].query("part not in ('field', 'step', 'patch')")
    return runs[runs["station"] == runs["station"].max() - step]


def finest_rows(runs: pd.DataFrame, part: str, step: int = 0) -> pd.DataFrame:
    """Return the rows of one part on the finest grid of each run, or ``step`` grids coarser."""
    rows = runs[runs["part"] == part].sort_values("cells", kind="stable")
    return rows.groupby(RUN_COLUMNS, sort=False).nth(-1 - step).set_index(RUN_COLUMNS)


def change(runs: pd.DataFrame, part: str, quantity: str) -> pd.Series:
    """Return the relative change of a quantity from the second finest to the finest grid."""
    return (finest_rows(runs, part)[quantity] / finest_rows(runs, part, 1)[quantity] - 1.0).abs()


def crossing_width(pulses: pd.DataFrame) -> pd.Series:
    """Return the distance that a front runs while its shear front comes down from the top."""
    return np.sqrt(2.0 * pulses["speed"] ** 2 / pulses.index.get_level_values("gamma") - 1.0)


def layer_regimes(evidence: Evidence, id: str) -> Qualitative:
    """Judge the regimes of the layer: pulses, a crack if the stress is held, one side stopped."""
    runs, moving = rows_at_station(evidence), ["speed", "pulse_slip"]
    pulses, before = (
        finest_rows(runs, "pulse"),
        finest_rows(rows_at_station(evidence, step=1), "pulse"),
    )
    drift = pulses[moving] / before[moving] - 1.0
    settled = (drift.abs() < evidence.tolerance(id)).all(axis=1) & (pulses["pulse_width"] > 0.0)
    cracks = ~np.isfinite(finest_rows(runs, "crack")["first_stick"])
    barriers = finest_rows(runs, "barrier")
    left, right = (barriers.xs(side, level="side") for side in (-1.0, 1.0))
    balance_distance = left["balance_distance"]
    left_arrests = left["end"] > -balance_distance
    right_runs_on = right["end"] > 2.0 * balance_distance
    stopped = left_arrests & right_runs_on & np.isfinite(left["first_stick"])
    further = {
        "pulses that stick and settle, displacement held": float(settled.sum()),
        "cracks that do not stick, stress held": float(cracks.sum()),
        "stopped on one side by a barrier, stress held": float(stopped.sum()),
    }
    return Qualitative(decided=[*settled, *cracks, *stopped], further=further)


def layer_width(evidence: Evidence, id: str) -> Approximate:
    """Compare the pulse width in two dimensions with the paper's formula."""
    runs = rows_at_station(evidence)
    pulses = finest_rows(runs, "pulse")
    ratio = pulses["pulse_width"] / pulses["paper_pulse_width"]
    deviations = (ratio - 1.0).abs()
    uncertainty = float((change(runs, "pulse", "pulse_width") * ratio).median())
    further = {}
    for quantity in ("speed", "pulse_slip"):
        words = f"median in the plane, divided by the formula: {quantity.replace('_', ' ')}"
        further[words] = float((pulses[quantity] / pulses[f"paper_{quantity}"]).median())
    further |= {"narrowest in the plane, divided by the formula": float(ratio.min())}
    further |= {"widest in the plane": float(ratio.max())}
    energies = pulses["fracture_energy"]
    return Approximate(
        tolerance=evidence.tolerance(id),
        deviations=deviations.to_numpy(),
        median=(float(deviations.median()), uncertainty),
        ratio=(float(ratio.median()), uncertainty),
        failing=rules.BEYOND,
        further=further,
        template_values={"least": float(energies.min()), "most": float(energies.max())}
        | {"spread": largest_spread(pulses)},
    )


def layer_stability(evidence: Evidence, id: str) -> Qualitative:
    """Judge that pulses are steady if the fracture energy is below the energy that is released.

    Fracture energies are divided by the energy that the layer releases, so that the limit is 1.
    """
    points = evidence.tables["layer_map"]
    brittle = points[points["fracture_energy"] < 1.0]
    tough = points[points["fracture_energy"] > 1.0]
    further = {f"points that are {name}": 0.0 for name in ("steady", "growing", "dying")}
    counted = points["outcome"].value_counts()
    further |= {f"points that are {name}": float(count) for name, count in counted.items()}
    further["dying with more fracture energy than is released"] = float(
        (tough["outcome"] == "dying").sum()
    )
    decided = [_is_steady(outcome) for outcome in brittle["outcome"]]
    return Qualitative(decided=decided, further=further)


def _is_steady(outcome: str) -> bool | None:
    """Return True if pulses from both sides settle; None if one of them was not tested."""
    return {"steady": True, "growing": False, "dying": False}.get(outcome)


def largest_spread(pulses: pd.DataFrame) -> float:
    """Return how much the fracture energy changes the pulse width, as a relative change.

    It is the largest width divided by the smallest, minus 1, for pulses that differ only in
    fracture energy.
    """
    widths = pulses["pulse_width"].groupby(level=["gamma", "tau0"]).agg(["max", "min", "count"])
    several = widths[widths["count"] > 1]
    return float((several["max"] / several["min"]).max() - 1.0)


def layer_in_plane(evidence: Evidence) -> dict[str, float]:
    """Return the numbers for the section on the premise: ranges of ratios and of other columns."""
    runs = rows_at_station(evidence)
    pulses = finest_rows(runs, "pulse")
    # The level at which the fracture energy is varied.
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
    out = {"pulses": float(len(pulses)), "level": level, "crossings": CROSSINGS_OF_TRANSITION}
    out |= {"spread": largest_spread(varied), "formula_speed": float(varied["paper_speed"].max())}
    for name, values in ranges.items():
        out |= {f"{name}_low": float(values.min()), f"{name}_high": float(values.max())}
    for quantity in CONVERGED_QUANTITIES:
        out[f"{quantity}_change"] = float(change(runs, "pulse", quantity).max())
    return out | across_a_step(evidence)


def across_a_step(evidence: Evidence) -> dict[str, float]:
    """Return the final slip of pulses that enter another pre-stress, and of uniform runs."""
    rows = evidence.tables["layer"].query("part == 'step'")
    rows = rows[rows["cells"] == rows["cells"].max()].sort_values("station")
    last = rows.groupby(["before", "tau0"])["pulse_slip"].last()
    low, high = float(rows["tau0"].min()), float(rows["tau0"].max())
    return {
        "lower": low,
        "higher": high,
        "upwards": float(last[low, high]),
        "downwards": float(last[high, low]),
        "uniform_lower": float(last[low, low]),
        "uniform_higher": float(last[high, high]),
    }
