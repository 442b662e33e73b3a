"""Draw a scene: slip velocity in time and space, fields at the end, and numbers beside theory."""

import math
from typing import Any

import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from slippulse.model.layer_units import Layer
from slippulse.plotting import space_time
from slippulse.plotting.selection import spaced_indices
from slippulse.plotting.si_tables import table_in_si, with_unit
from slippulse.plotting.style import BLUE, GREY, ORANGE, PAGE_WIDTH, Look, by_role, panel_letter

from ..text.numerals import MAX_DIGITS, number, with_uncertainty
from .shared.main_numbers import with_symbols

# How many blocks of a profile are drawn.
PROFILE_POINTS = 400
FIELDS = {"slip_velocity": r"slip velocity $\dot u$", "slip": r"slip $u$"}
# The number of a steady pulse that equals the largest value of each field.
LARGEST_VALUES = {"slip_velocity": "pulse_peak_velocity", "slip": "pulse_slip"}


def table(
    run: xr.Dataset,
    numbers: pd.DataFrame,
    theory: pd.Series,
    title: str,
    layer: Layer | None = None,
) -> pd.DataFrame:
    """Return everything that the figure shows, with a role in each row.

    The roles of `run_table` are joined by title, profile (a field at the end), steady (the largest
    value of a field in the exact steady pulse of each side) and number (a row of ``numbers``).

    numbers : from `main_numbers.scene_numbers`; in SI units if there is a layer
    theory : measured and predicted numbers of the run
    layer : the layer in SI units, which the table then has, too
    """
    lower, upper = space_time.drawn_range(run)
    x = run["x"].values
    inside = np.flatnonzero((x >= lower) & (x <= upper))
    parts = [pd.DataFrame([{"role": "title", "series": title}]), space_time.run_table(run)]
    # The right pulse has a measured state. On the left there is a pulse if any block has stuck.
    ends = {} if theory["pulse_state"] in ("none", "stopped") else {"exact": upper}
    if math.isfinite(run.attrs["first_stick_time"]):
        ends = {"exact_left": lower} | ends
    steady = []
    for name, largest in LARGEST_VALUES.items():
        values = run[name].values
        spaced = inside[spaced_indices(inside.size, PROFILE_POINTS)]
        kept = np.union1d(spaced, inside[np.argmax(values[inside])])
        rows = {"role": "profile", "series": name, "position": x[kept], "value": values[kept]}
        parts.append(pd.DataFrame(rows))
        steady += [(name, end, theory[f"{prefix}_{largest}"]) for prefix, end in ends.items()]
    rows = pd.DataFrame(steady, columns=["series", "position", "value"])
    parts.append(rows.assign(role="steady").dropna())
    parts.append(numbers.rename(columns={"quantity": "series"}).assign(role="number"))
    columns = ["role", "series", "label", "time", "position", "value", "uncertainty", "theory"]
    rows = pd.concat(parts, ignore_index=True)
    if layer is None:
        return rows.reindex(columns=columns)
    return table_in_si(rows, layer).reindex(columns=[*columns, "unit"])


def draw(table: pd.DataFrame) -> Figure:
    """Draw pre-stress and map, both fields at the end with exact steady pulses, and the numbers."""
    roles, none = by_role(table), table.iloc[:0]
    numbers, steady = roles.get("number", none), roles.get("steady", none)
    rows = math.ceil(len(numbers) / 2)
    figure = Figure(figsize=(PAGE_WIDTH, 4.9 + 0.16 * rows), layout="constrained")
    heights = (3.1, 1.6, 0.2 + 0.16 * rows)
    upper, lower, text = figure.subfigures(3, 1, squeeze=False, height_ratios=heights).flat
    profile, axes = upper.subplots(1, 2, sharey=True, width_ratios=(0.16, 1.0))
    space_time.draw_profile(profile, roles)
    space_time.draw_map(axes, roles)
    axes.legend(loc="upper left")
    panel_letter(profile, "a")
    title = str(roles["title"]["series"].iloc[0]).replace("$", r"\$")
    upper.suptitle(f"{title}\n{space_time.run_title(roles)}")
    panels = zip(lower.subplots(1, 2), "bc", FIELDS.items(), strict=True)
    for axes, letter, (field, name) in panels:
        ends = roles["profile"][roles["profile"]["series"] == field]
        axes.axhline(0.0, color=GREY, linewidth=0.5)
        axes.plot(ends["position"], ends["value"], color=BLUE, label="simulated")
        look: Look = {"color": ORANGE, "gid": "steady", "label": "steady pulse of this side, exact"}
        for pulse in steady[steady["series"] == field].itertuples():
            axes.plot([0.0, pulse.position], [pulse.value] * 2, "--", **look)
        # The velocity is 0 in the middle, where the legend fits. Its entries hold for both panels.
        if len(axes.lines) > 2 and field == "slip_velocity":
            axes.legend(handles=axes.lines[1:3], loc="center")
        axes.set_xlabel(with_unit(r"position $x$", roles, "position"))
        # A label with a unit needs a second line, since the panel is low.
        end = "\nat the end" if "unit" in roles else " at the end"
        axes.set_ylabel(with_unit(name, roles, field) + end)
        axes.set_xlim(ends["position"].min(), ends["position"].max())
        panel_letter(axes, letter)
    for index, row in enumerate(numbers.itertuples()):
        measured = f"{with_uncertainty(row.value, row.uncertainty)} {_unit(row)}".strip()
        line = f"{with_symbols(row.label)}: {measured}"
        if math.isfinite(row.theory):
            line += f" (theory {number(row.theory, MAX_DIGITS)})"
        height = 1.0 - (index // 2 + 0.6) / (rows + 0.4)
        text.text(0.06 + 0.48 * (index % 2), height, line, va="center")
    return figure


def _unit(row: Any) -> str:
    """Return the unit of a number; empty if the table is not in SI units."""
    unit = getattr(row, "unit", "")
    return unit if isinstance(unit, str) else ""
