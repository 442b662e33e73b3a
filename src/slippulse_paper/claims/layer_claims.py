"""Claims and numbers about the layer in the plane, which the paper averages over its height."""

import numpy as np
import pandas as pd

from . import rules
from .evidence import Evidence
from .kinds import Approximate, Qualitative

QUANTITIES = ("speed", "pulse_width", "pulse_slip")
# A point of the undamped pulse slides for W/v = pi tau_0/sqrt(gamma); a shear wave goes to the top
# and back in 2 sqrt(2/gamma). This is the ratio of the two, over tau_0.
CROSSINGS = np.pi / np.sqrt(8.0)


def station(evidence: Evidence, step: int = 0) -> pd.DataFrame:
    """Rows of all grids at the station nearest to the front, or at one some steps before."""
    runs = evidence.tables["layer"].query("part != 'field'")
    return runs[runs["station"] == np.sort(runs["station"].unique())[-1 - step]]


def finest(runs: pd.DataFrame, part: str, step: int = 0) -> pd.DataFrame:
    """Rows of one part on its finest grid, or on the grid that is some steps coarser."""
    rows = runs[runs["part"] == part]
    cells = np.sort(rows["cells"].unique())[-1 - step]
    return rows[rows["cells"] == cells].set_index(["gamma", "tau0", "weakening", "side"])


def change(runs: pd.DataFrame, part: str, quantity: str) -> pd.Series:
    """Relative change of a number of each run from the second finest grid to the finest."""
    return (finest(runs, part)[quantity] / finest(runs, part, 1)[quantity] - 1.0).abs()


def layer_regimes(evidence: Evidence, id: str) -> Qualitative:
    """Pulses that settle, a crack where the stress is held, and one side stopped by a barrier."""
    runs, moving = station(evidence), ["speed", "pulse_slip"]
    pulses, before = finest(runs, "pulse"), finest(station(evidence, step=1), "pulse")
    drift = pulses[moving] / before[moving] - 1.0
    settled = (drift.abs() < evidence.tolerance(id)).all(axis=1) & (pulses["pulse_width"] > 0.0)
    cracks = ~np.isfinite(finest(runs, "crack")["first_stick"])
    barriers = finest(runs, "barrier")
    left, right = (barriers.xs(side, level="side") for side in (-1.0, 1.0))
    way = left["balance_distance"]
    stopped = (left["end"] > -way) & (right["end"] > 2.0 * way) & np.isfinite(left["first_stick"])
    further = {
        "pulses that stick and settle, displacement held": float(settled.sum()),
        "cracks that do not stick, stress held": float(cracks.sum()),
        "stopped on one side by a barrier, stress held": float(stopped.sum()),
    }
    return Qualitative(decided=[*settled, *cracks, *stopped], further=further)


def layer_width(evidence: Evidence, id: str) -> Approximate:
    """The paper's width against that of pulses in the plane."""
    runs = station(evidence)
    pulses = finest(runs, "pulse")
    ratio = pulses["pulse_width"] / pulses["paper_pulse_width"]
    deviations = (ratio - 1.0).abs()
    damped = pulses["damped_pulse_width"] / pulses["paper_pulse_width"]
    levels = pulses.reset_index()
    fracture = float((levels["gamma"] * levels["weakening"] / levels["tau0"] ** 2).max())
    uncertainty = float((change(runs, "pulse", "pulse_width") * ratio).median())
    further = {}
    for quantity in ("speed", "pulse_slip", "first_stick"):
        words = f"median of plane over formula, {quantity.replace('_', ' ')}"
        further[words] = float((pulses[quantity] / pulses[f"paper_{quantity}"]).median())
    for name, widths in (("in the plane", ratio), ("in one dimension, as weakened", damped)):
        further |= {f"narrowest {name}, over the formula": float(widths.min())}
        further |= {f"widest {name}": float(widths.max())}
    return Approximate(
        tolerance=evidence.tolerance(id),
        deviations=deviations.to_numpy(),
        median=(float(deviations.median()), uncertainty),
        ratio=(float(ratio.median()), uncertainty),
        failing=rules.BEYOND,
        further=further,
        told={"fracture": fracture, "crossings": CROSSINGS},
    )


def layer_in_plane(evidence: Evidence) -> dict[str, float]:
    """Numbers of the section on the premise: ends of ratios, of changes and of other columns."""
    runs, study = station(evidence), evidence.tables["layer"]
    pulses, barriers = finest(runs, "pulse").reset_index(), finest(runs, "barrier")
    work = 2.0 * pulses["tau0"] * pulses["pulse_slip"]
    kept = pulses["gamma"] * pulses["pulse_slip"] ** 2 + pulses["weakening"]
    ranges = {name: pulses[name] for name in ("gamma", "tau0", "speed")}
    ranges |= {
        "first_stick": pulses["paper_first_stick"] / pulses["first_stick"],
        "strip": pulses["strip_first_stick"] / pulses["first_stick"],
        "waves": 1.0 - kept / work,
        "damped": pulses["damped_pulse_width"] / pulses["pulse_width"],
        "stop": runs[(runs["part"] == "barrier") & (runs["side"] < 0.0)]["end"],
    }
    for name, gamma in (("thick", pulses["gamma"].max()), ("thin", pulses["gamma"].min())):
        rows = pulses[pulses["gamma"] == gamma]
        for quantity in QUANTITIES:
            ranges[f"{name}_{quantity}"] = rows[f"paper_{quantity}"] / rows[quantity]
    out = {"pulses": float(len(pulses)), "balance": -float(barriers["balance_distance"].max())}
    out |= {"widest": float(pulses["pulse_width"].max()), "crossings": CROSSINGS}
    for name, values in ranges.items():
        out |= {f"{name}_low": float(values.min()), f"{name}_high": float(values.max())}
    for quantity in QUANTITIES:
        out[f"{quantity}_change"] = float(change(runs, "pulse", quantity).max())
        out[f"{quantity}_fine"] = float(change(runs, "fine", quantity).max())
    free = finest(study, "free").sort_values("station").iloc[-2:]
    out["free_speed"] = float(free["speed"].iloc[1])
    out["free_before"], out["free_slip"] = free["pulse_slip"].tolist()
    for step, name in ((0, "cells"), (1, "coarse_cells")):
        out[name] = float(finest(runs, "pulse", step).reset_index()["cells"].max())
    return out | coupled(evidence)


def coupled(evidence: Evidence) -> dict[str, float]:
    """Slip at two stations where the strength follows the normal stress, least and most."""
    rows = evidence.tables["layer"].query("part == 'coupled'").query("cells == cells.max()")
    slips = rows.pivot(index=["coupling", "side"], columns="station", values="pulse_slip")
    couplings = {"weak": rows["coupling"].min(), "strong": rows["coupling"].max()}
    out = {name: float(coupling) for name, coupling in couplings.items()}
    for name, coupling in couplings.items():
        for side, sign in (("right", 1.0), ("left", -1.0)):
            before, after = slips.loc[(coupling, sign)].iloc[-2:]
            out |= {f"{name}_{side}_before": float(before), f"{name}_{side}": float(after)}
    return out
