"""Pulses in their own frame, simulated and in theory: rows of a figure's table, and how they are drawn."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.lines import Line2D

from ...data.points import point
from ...measure.pulses import comoving, leading_pulse
from ...model.scene import prestress_from
from ...theory.arrest import ArrestingCrack
from ...theory.front_law import front_speed
from ...theory.pulse import paper_pulse, steady_pulse
from ..style import BLUE, GREEN, ORANGE, PURPLE, SKY

FIELDS = {
    "slip": r"slip $\bar u$",
    "slip_velocity": r"slip velocity $\dot{\bar u}$",
    "slip_acceleration": r"slip acceleration $\ddot{\bar u}$",
}
COLOURS = (BLUE, ORANGE, GREEN, PURPLE, SKY)
# Points of a drawn curve; a pulse of many more blocks is thinned to this.
POINTS = 400
MARGIN = 0.25


def pulse_rows(sweep: xr.Dataset, window: float, fields: tuple[str, ...]) -> pd.DataFrame:
    """Simulated pulses of a sweep, and theory beside each.

    Parameters
    ----------
    sweep : a sweep with fields
    window : share of the front's path that its speed is measured on
    fields : which of FIELDS

    Returns
    -------
    rows of role "simulation", "theory" (exact, damped), "paper" (the paper's formula, for undamped runs) and "peak"
    (exact peak velocity in the continuum, under a stress boundary) over x = chi, with chi = 0 at the largest velocity
    """
    parts = []
    for index in range(sweep.sizes["point"]):
        run = point(sweep, index)
        pulse = leading_pulse(run, window)
        fields_here = comoving(run, pulse)
        xi_peak = pulse.peak_distance - pulse.front
        label = {"run": index} | {
            key: run.attrs[key] for key in ("left", "right", "width", "gamma", "damping_ratio", "run_flags")
        }
        if run.attrs["boundary"] == "displacement":
            speed = float(front_speed(label["left"], label["damping_ratio"], run.attrs["release"]))
            theory = steady_pulse(label["left"], label["gamma"], run.attrs["beta"], speed)
            span = theory.width
            parts.append(theory_rows(theory, "theory", fields, label))
            if label["damping_ratio"] == 0.0:
                parts.append(theory_rows(paper_pulse(label["left"], label["gamma"]), "paper", fields, label))
        else:
            crack = ArrestingCrack(prestress_from(run.attrs), label["damping_ratio"], run.attrs["release"])
            far = far_rows(crack, fields, label)
            parts.append(far)
            span = -float(far["x"].min())
            if "slip_velocity" in fields:
                peak = {"role": "peak", "field": "slip_velocity", "x": 0.0, "y": crack.peak_velocity}
                parts.append(pd.DataFrame([peak | label]))
        parts.append(simulated_rows(fields_here, xi_peak, span, fields, label, run.attrs["boundary"]))
    return pd.concat(parts, ignore_index=True)


def simulated_rows(fields, xi_peak: float, span: float, names, label: Mapping, boundary: str) -> pd.DataFrame:
    """One simulated pulse around its peak, thinned."""
    xi = fields["xi"]
    before = -(1.0 + MARGIN) * span if boundary == "displacement" else xi_peak - span
    ahead = 0.08 * span
    inside = (xi > before) & (xi < ahead)
    step = max(1, int(np.count_nonzero(inside) / POINTS))
    parts = []
    for name in names:
        # The slip of the stuck blocks is part of the picture; velocity and acceleration there are zero.
        parts.append(
            pd.DataFrame(
                {
                    "role": "simulation",
                    "field": name,
                    "x": (xi - xi_peak)[inside][::step],
                    "y": fields[name][inside][::step],
                }
            ).assign(**label)
        )
    return pd.concat(parts, ignore_index=True)


def theory_rows(pulse, role: str, names, label: Mapping) -> pd.DataFrame:
    """One pulse of the theory around its peak."""
    xi = np.linspace(-(1.0 + MARGIN) * pulse.width, 0.08 * pulse.width, POINTS)
    # The corners at the front and at the trailing edge are kept sharp.
    xi = np.unique(np.concatenate([xi, [-pulse.width, 0.0]]))
    values = dict(zip(FIELDS, pulse.profile(xi), strict=True))
    parts = [
        pd.DataFrame({"role": role, "field": name, "x": xi - pulse.peak_position, "y": values[name]}).assign(
            **label
        )
        for name in names
    ]
    return pd.concat(parts, ignore_index=True)


def far_rows(crack: ArrestingCrack, names, label: Mapping) -> pd.DataFrame:
    """The exact far-field pulse under a stress boundary, in the continuum, with its integral and derivative."""
    delay, velocity = crack.far_pulse()
    order = np.argsort(delay, kind="stable")
    delay, velocity = delay[order], velocity[order]
    shown = velocity > 1e-3 * velocity.max()
    start = max(0, int(np.argmax(shown)) - 1)
    x, v = delay[start:] - delay[int(np.argmax(velocity))], velocity[start:]
    keep = np.concatenate([[True], np.diff(x) > 1e-9 * np.ptp(x)])
    x, v = x[keep], v[keep]
    step = max(1, x.size // POINTS)
    # The pulse moves at the wave speed without changing, so slip is the integral of its velocity over distance.
    slip = np.concatenate([np.cumsum((0.5 * (v[1:] + v[:-1]) * np.diff(x))[::-1])[::-1], [0.0]])
    curves = {"slip": slip, "slip_velocity": v, "slip_acceleration": -np.gradient(v, x)}
    parts = [
        pd.DataFrame({"role": "theory", "field": name, "x": x[::step], "y": curves[name][::step]}).assign(
            **label
        )
        for name in names
    ]
    return pd.concat(parts, ignore_index=True)


def prestress_rows(sweep: xr.Dataset, reach: float) -> pd.DataFrame:
    """Distinct pre-stress profiles of a sweep, for an inset; ``reach`` in units of the widest Gaussian."""
    x = np.linspace(-1.0, 1.0, 161) * reach * float(sweep["width"].max())
    parts, seen = [], set()
    for index in range(sweep.sizes["point"]):
        run = point(sweep, index)
        key = (run.attrs["left"], run.attrs["right"], run.attrs["width"], run.attrs["steps_and_bumps"])
        if key not in seen:
            seen.add(key)
            parts.append(
                pd.DataFrame({"role": "inset", "x": x, "y": prestress_from(run.attrs)(x)}).assign(
                    run=index, left=key[0], right=key[1], width=key[2]
                )
            )
    return pd.concat(parts, ignore_index=True)


def draw_displacement(axes, rows: pd.DataFrame, field: str) -> None:
    """Pulses under a displacement boundary: colour by tau_0, simulation as pale lines, theory dashed by damping."""
    rows = rows[rows["field"] == field]
    styles = dict(zip(np.sort(rows["damping_ratio"].unique()), ("-", "--", ":", "-."), strict=False))
    for colour, (tau0, level) in zip(COLOURS, rows.groupby("left"), strict=False):
        for ratio, group in level.groupby("damping_ratio"):
            for role, options in (
                ("simulation", {"linewidth": 3.0, "alpha": 0.35, "linestyle": "-", "zorder": 2}),
                ("theory", {"linewidth": 0.9, "linestyle": styles[ratio], "zorder": 3}),
            ):
                curve = group[group["role"] == role]
                if role == "simulation" and curve["run_flags"].notna().any():
                    options = options | {"color": "0.7"}
                axes.plot(
                    curve["x"],
                    curve["y"],
                    **({"color": colour} | options),
                    gid=f"{role} {tau0:g} {ratio:g}",
                )


def draw_stress(axes, rows: pd.DataFrame, field: str) -> None:
    """Pulses under a stress boundary, one colour a profile."""
    rows = rows[rows["field"] == field]
    for colour, (run, group) in zip(COLOURS, rows.groupby("run"), strict=False):
        curve = group[group["role"] == "simulation"]
        pale = "0.7" if curve["run_flags"].notna().any() else colour
        axes.plot(curve["x"], curve["y"], color=pale, linewidth=3.0, alpha=0.35, gid=f"simulation {run}")
        theory = group[group["role"] == "theory"]
        axes.plot(theory["x"], theory["y"], color=colour, linewidth=0.9, zorder=3, gid=f"theory {run}")


def draw_prestress(inset, rows: pd.DataFrame, by: str) -> None:
    """Pre-stress profiles in an inset, in the colours of the pulses."""
    for colour, (_, group) in zip(COLOURS, rows.groupby(by), strict=False):
        inset.plot(group["x"], group["y"], color=colour, linewidth=0.9)
    inset.set_xlabel(r"$\bar x$", fontsize=6.5, labelpad=0)
    inset.set_ylabel(r"$\bar\tau$", fontsize=6.5, labelpad=0)
    inset.tick_params(labelsize=5.5, length=2)


def displacement_handles(rows: pd.DataFrame) -> list[Line2D]:
    """Legend: colours are tau_0, line styles the damping of the theory, pale lines the simulation."""
    levels = np.sort(rows.loc[rows["role"] == "theory", "left"].unique())
    ratios = np.sort(rows.loc[rows["role"] == "theory", "damping_ratio"].unique())
    handles = [
        Line2D([], [], color=colour, label=rf"$\bar\tau_0 = {level:g}$")
        for colour, level in zip(COLOURS, levels, strict=False)
    ]
    handles += [
        Line2D(
            [],
            [],
            color="black",
            linewidth=0.9,
            linestyle=style,
            label=rf"theory, $\bar\beta/\mathrm{{d}}\bar x = {ratio:g}$",
        )
        for style, ratio in zip(("-", "--", ":", "-."), ratios, strict=False)
    ]
    return [*handles, Line2D([], [], color="black", linewidth=3.0, alpha=0.35, label="simulation")]


def stress_handles(rows: pd.DataFrame) -> list[Line2D]:
    """Legend: one colour a profile, dashes the exact peak."""
    runs = rows[rows["role"] == "simulation"].groupby("run").first()
    handles = [
        Line2D(
            [],
            [],
            color=colour,
            label=rf"$\bar\tau_{{0,l}} = {run.left:g}$, $\bar W_{{\bar\tau}} = {run.width:g}$",
        )
        for colour, run in zip(COLOURS, runs.itertuples(), strict=False)
    ]
    return [
        *handles,
        Line2D([], [], color="black", linewidth=0.9, label="exact far-field pulse"),
        Line2D([], [], color="black", linewidth=0.8, linestyle=(0, (2, 1)), label="its largest velocity"),
        Line2D([], [], color="black", linewidth=3.0, alpha=0.35, label="simulation"),
    ]
