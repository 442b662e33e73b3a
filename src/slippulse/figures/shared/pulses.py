"""Pulses in their own frame, simulated and in theory: rows of a figure's table, and how they are drawn."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.lines import Line2D
from matplotlib.ticker import MaxNLocator

from ...data.points import point
from ...measure.pulses import comoving, leading_pulse
from ...model.scene import prestress_from
from ...theory.arrest import ArrestingCrack
from ...theory.front_law import front_speed
from ...theory.pulse import paper_pulse, steady_pulse
from ..style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, colour_scale

FIELDS = {
    "slip": r"slip $u$",
    "slip_velocity": r"slip velocity $\dot u$",
    "slip_acceleration": r"slip acceleration $\ddot u$",
}
COLOURS = (BLUE, ORANGE, GREEN, PURPLE, SKY)
STYLES = ("-", "--", ":", "-.")
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
    rows of role "simulation", "theory" (exact, damped), "paper" (the paper's formula, for undamped runs), "peak" (exact
    peak velocity in the continuum, under a stress boundary) and "residual" (simulation less theory) over x = chi, with
    chi = 0 at the largest velocity; x_scale and y_scale are what they are drawn in units of: the width of the paper's
    pulse and its largest values, or the width of the Gaussian and the largest values of the exact far-field pulse
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
        rows = []
        if run.attrs["boundary"] == "displacement":
            speed = float(front_speed(label["left"], label["damping_ratio"], run.attrs["release"]))
            theory = steady_pulse(label["left"], label["gamma"], run.attrs["beta"], speed)
            span = theory.width
            exact = theory_rows(theory, "theory", fields, label)
            paper = paper_pulse(label["left"], label["gamma"])
            of_paper, x_scale = theory_rows(paper, "paper", fields, label), paper.width
            y_scale = of_paper.groupby("field")["y"].max()
            if label["damping_ratio"] == 0.0:
                rows.append(of_paper)
        else:
            crack = ArrestingCrack(prestress_from(run.attrs), label["damping_ratio"], run.attrs["release"])
            exact = far_rows(crack, fields, label)
            span, x_scale = -float(exact["x"].min()), label["width"]
            y_scale = exact.groupby("field")["y"].max()
            # The acceleration has no bound; its scale is that of a velocity gained over a width.
            if "slip_acceleration" in fields:
                y_scale["slip_acceleration"] = crack.peak_velocity / label["width"]
            if "slip_velocity" in fields:
                peak = {"role": "peak", "field": "slip_velocity", "x": 0.0, "y": crack.peak_velocity}
                rows.append(pd.DataFrame([peak | label]))
        simulated = simulated_rows(fields_here, xi_peak, span, fields, label, run.attrs["boundary"])
        found = pd.concat([*rows, exact, simulated, residual_rows(simulated, exact)])
        parts.append(found.assign(x_scale=x_scale, y_scale=found["field"].map(y_scale)))
    return pd.concat(parts, ignore_index=True)


def residual_rows(simulated: pd.DataFrame, exact: pd.DataFrame) -> pd.DataFrame:
    """Simulation less theory, where there is theory."""
    parts = []
    for field, rows in simulated.groupby("field"):
        curve = exact[exact["field"] == field].sort_values("x")
        theory = np.interp(rows["x"], curve["x"], curve["y"], left=np.nan, right=0.0)
        parts.append(rows.assign(role="residual", y=rows["y"] - theory))
    return pd.concat(parts)


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


def tau_colours(rows: pd.DataFrame) -> dict:
    """The colour of each pre-stress level of pulses under a displacement boundary."""
    scale = colour_scale("tau_0")
    return {level: scale.to_rgba(level) for level in np.sort(rows["left"].dropna().unique())}


def profile_colours(rows: pd.DataFrame) -> dict:
    """The colour of each run under a stress boundary."""
    return dict(zip(np.sort(rows["run"].dropna().unique()), COLOURS, strict=False))


def draw_displacement(axes, strip, rows: pd.DataFrame, field: str) -> None:
    """Pulses in units of the paper's: colour by tau_0, simulation as pale lines, theory by damping; residual below."""
    rows = rows[rows["field"] == field]
    colours = tau_colours(rows)
    styles = dict(zip(np.sort(rows["damping_ratio"].unique()), STYLES, strict=False))
    for (level, ratio), group in rows.groupby(["left", "damping_ratio"]):
        _draw_pulse(axes, strip, group, colours[level], styles[ratio], f"{level:g} {ratio:g}")


def draw_stress(axes, strip, rows: pd.DataFrame, field: str) -> None:
    """Pulses under a stress boundary over the width of their Gaussian, one colour a profile; residual below."""
    rows = rows[rows["field"] == field]
    colours = profile_colours(rows)
    for run, group in rows.groupby("run"):
        _draw_pulse(axes, strip, group, colours[run], "-", f"{run:g}")


def _draw_pulse(axes, strip, rows: pd.DataFrame, colour, style: str, name: str) -> None:
    for role, where, look in (
        ("simulation", axes, {"linewidth": 2.4, "alpha": 0.35, "zorder": 2}),
        ("theory", axes, {"linewidth": 0.8, "linestyle": style, "zorder": 3}),
        ("residual", strip, {"linewidth": 0.6, "linestyle": style}),
    ):
        curve = rows[rows["role"] == role]
        flagged = role != "theory" and curve["run_flags"].notna().any()
        where.plot(
            curve["x"] / curve["x_scale"], curve["y"] / curve["y_scale"], gid=f"{role} {name}",
            color="0.7" if flagged else colour, **look,
        )  # fmt: skip


def draw_prestress(inset, rows: pd.DataFrame, by: str, colours: Mapping) -> None:
    """Pre-stress profiles in an inset, in the colours of the pulses."""
    for key, group in rows.groupby(by):
        inset.plot(group["x"], group["y"], color=colours[key], linewidth=0.8)
    inset.set_ylim(min(-0.1, 1.3 * float(rows["y"].min())), 1.1)
    inset.yaxis.set_major_locator(MaxNLocator(3, integer=True))
    inset.set_title(r"$\tau(x)$", fontsize=7.0, pad=1.0)
    inset.tick_params(labelsize=7.0, length=1.5, pad=1.0)


def displacement_handles(rows: pd.DataFrame) -> list[Line2D]:
    """Legend: colours are tau_0, line styles the damping of the theory, pale lines the simulation."""
    ratios = np.sort(rows.loc[rows["role"] == "theory", "damping_ratio"].unique())
    handles = [
        Line2D([], [], color=colour, label=rf"$\tau_0 = {level:g}$")
        for level, colour in tau_colours(rows).items()
    ]
    damping = r"exact, $b = "
    handles += [
        Line2D([], [], color=BLACK, linewidth=0.8, linestyle=style, label=f"{damping}{ratio:g}$")
        for style, ratio in zip(STYLES, ratios, strict=False)
    ]  # fmt: skip
    return [*handles, Line2D([], [], color=BLACK, linewidth=2.4, alpha=0.35, label="simulation")]


def stress_handles(rows: pd.DataFrame) -> list[Line2D]:
    """Legend: one colour a profile."""
    runs = rows[rows["role"] == "simulation"].groupby("run").first()
    handles = []
    for run, colour in profile_colours(rows).items():
        level, width = runs.loc[run, "left"], runs.loc[run, "width"]
        label = rf"$\tau_{{0,l}} = {level:g}$, $W = {width:g}$"
        handles.append(Line2D([], [], color=colour, label=label))
    return [
        *handles,
        Line2D([], [], color=BLACK, linewidth=0.8, label="exact far-field pulse"),
        Line2D([], [], color=BLACK, linewidth=2.4, alpha=0.35, label="simulation"),
    ]
