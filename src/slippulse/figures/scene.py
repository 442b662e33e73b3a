"""One scene: slip velocity over time and position, the profile at the end, and its numbers beside theory."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..comparison.scene_numbers import far_pulse
from ..data.numerals import MOST, number, with_uncertainty
from .shared.space_time import draw_map, draw_profile, edges, limits, prestress_profile, thin, velocity_map
from .style import BLUE, GREY, ORANGE, PAGE, new_figure, panel_letter

COLUMNS = ["role", "series", "time", "position", "value", "uncertainty", "theory"]
PARAMETERS = ("left", "right", "width", "gamma", "damping_ratio", "dx")
# Blocks drawn of a profile, points of the theory's.
PROFILE_POINTS, THEORY_POINTS = 1200, 200


def table(run: xr.Dataset, numbers: pd.DataFrame, settings: Mapping) -> pd.DataFrame:
    """Everything that the figure draws.

    Parameters
    ----------
    run : one run with fronts, fields and samples
    numbers : `slippulse.comparison.scene_numbers` of it
    settings : title

    Returns
    -------
    DataFrame with role, series, time, position, value, uncertainty, theory. Roles: map, largest, prestress, front,
    trailing as in figure 4; profile (series slip or slip_velocity, at the end); theory (the same of the steady pulse,
    its front where the right front is); number (series: its label); parameter; title and flag (series: the text).
    """
    texts = [{"role": "title", "series": settings["title"]}]
    if run.attrs["run_flags"]:
        texts.append({"role": "flag", "series": run.attrs["run_flags"]})
    parts = [
        pd.DataFrame(texts),
        pd.DataFrame(
            [{"role": "parameter", "series": name, "value": run.attrs[name]} for name in PARAMETERS]
        ),
        pd.DataFrame(
            [
                {
                    "role": "parameter",
                    "series": "leaf springs",
                    "value": float(run.attrs["boundary"] == "displacement"),
                }
            ]
        ),
        velocity_map(run),
        prestress_profile(run),
        *edges(run),
        *_profiles(run),
        *_theory(run, numbers),
        numbers.assign(role="number", series=numbers["label"]),
    ]
    return pd.concat([part for part in parts if len(part)], ignore_index=True).reindex(columns=COLUMNS)


def _profiles(run: xr.Dataset) -> list[pd.DataFrame]:
    lower, upper = limits(run)
    x = run["x"].values
    inside = np.flatnonzero((x >= lower) & (x <= upper))
    largest = inside[[int(np.argmax(run["slip_velocity"].values[inside]))]]
    kept = np.union1d(inside[thin(inside.size, PROFILE_POINTS)], largest)
    return [
        pd.DataFrame(
            {"role": "profile", "series": name, "position": x[kept], "value": run[name].values[kept]}
        )
        for name in ("slip_velocity", "slip")
    ]


def _theory(run: xr.Dataset, numbers: pd.DataFrame) -> list[pd.DataFrame]:
    """The steady pulse behind the right front, where a pulse has formed."""
    pulse = far_pulse(run.attrs)
    if pulse is None or "pulse_width" not in set(numbers["quantity"]):
        return []
    released = np.flatnonzero(np.isfinite(run["release_time"].values))
    front = float(run["x"].values[released[-1]])
    xi = np.linspace(-1.6 * pulse.width, 0.0, THEORY_POINTS)
    slip, velocity, _ = pulse.profile(xi)
    return [
        pd.DataFrame({"role": "theory", "series": name, "position": front + xi, "value": values})
        for name, values in (("slip_velocity", velocity), ("slip", slip))
    ]


def number_text(value: float, uncertainty: float, theory: float) -> str:
    """A number with its uncertainty, "?" where the grid study has none, and the theory's beside it."""
    text = with_uncertainty(value, uncertainty, "(?)")
    return f"{text} (theory {number(theory, MOST)})" if math.isfinite(theory) else text


def plot(table: pd.DataFrame) -> Figure:
    """Draw the figure from its table."""
    roles = {role: rows for role, rows in table.groupby("role")}
    numbers = list(roles["number"].itertuples()) if "number" in roles else []
    lines = [
        f"{row.series}: {number_text(row.value, row.uncertainty, row.theory)}".replace(
            "|x_minus|", r"$|x_-|$"
        )
        .replace("T_trans", r"$T_\mathrm{trans}$")
        .replace("L_trans", r"$L_\mathrm{trans}$")
        for row in numbers
    ]
    rows = math.ceil(len(lines) / 2)
    figure = new_figure(PAGE, 4.9 + 0.16 * rows)
    upper, lower, text = figure.subfigures(3, 1, height_ratios=(3.1, 1.6, 0.2 + 0.16 * rows))
    _draw_space_time(upper, roles)
    _draw_end(lower, roles)
    for index, line in enumerate(lines):
        text.text(
            0.06 + 0.48 * (index % 2),
            1.0 - (index // 2 + 0.6) / (rows + 0.4),
            line,
            va="center",
            fontsize=8.0,
        )
    return figure


def _draw_space_time(figure, roles: Mapping[str, pd.DataFrame]) -> None:
    profile, space_time = figure.subplots(1, 2, sharey=True, width_ratios=(0.16, 1.0))
    draw_profile(profile, roles["prestress"])
    image = draw_map(space_time, roles)
    handles = [line for line in space_time.lines if not line.get_label().startswith("_")]
    space_time.legend(handles=handles, loc="upper left")
    figure.colorbar(image, ax=space_time, pad=0.015, aspect=25).set_label(r"slip velocity $\dot u$")
    profile.set_ylabel(r"position $x$")
    panel_letter(profile, "a")
    title = str(roles["title"]["series"].iloc[0]).replace("$", r"\$")
    figure.suptitle(f"{title}\n{_parameters(roles)}", fontsize=9.0)


def _parameters(roles: Mapping[str, pd.DataFrame]) -> str:
    value = roles["parameter"].set_index("series")["value"]
    parts = [rf"$\Gamma = {int(value['leaf springs'])}$"]
    if value["leaf springs"]:
        parts.append(rf"$\gamma = {value['gamma']:g}$")
    if value["left"] == value["right"]:
        parts.append(rf"$\tau_0 = {value['left']:g}$")
    else:
        parts += [rf"$\tau_{{0,l}} = {value['left']:g}$", rf"$\tau_{{0,r}} = {value['right']:g}$"]
    parts += [
        rf"$W = {value['width']:g}$",
        rf"$\beta/\Delta x = {value['damping_ratio']:g}$",
        rf"$\Delta x = {value['dx']:g}$",
    ]
    if "flag" in roles:
        parts.append(f"flagged: {roles['flag']['series'].iloc[0]}".replace("_", " "))
    return ", ".join(parts)


def _draw_end(figure, roles: Mapping[str, pd.DataFrame]) -> None:
    panels = figure.subplots(1, 2)
    for axes, letter, series, label in zip(
        panels,
        "bc",
        ("slip_velocity", "slip"),
        (r"slip velocity $\dot u$ at the end", r"slip $u$ at the end"),
        strict=True,
    ):
        rows = roles["profile"][roles["profile"]["series"] == series]
        axes.axhline(0.0, color=GREY, linewidth=0.5)
        axes.plot(rows["position"], rows["value"], color=BLUE, label="simulated")
        if "theory" in roles:
            theory = roles["theory"][roles["theory"]["series"] == series]
            axes.plot(
                theory["position"],
                theory["value"],
                color=ORANGE,
                linestyle=(0, (3, 1.5)),
                label="steady pulse, theory",
            )
            if letter == "b":
                axes.legend(loc="upper center")
        axes.set_xlabel(r"position $x$")
        axes.set_ylabel(label)
        axes.set_xlim(rows["position"].min(), rows["position"].max())
        panel_letter(axes, letter)
