"""Animate a scene: slip velocity and slip as functions of position."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from slippulse.data.files import write_whole
from slippulse.data.readable_units import readable_unit
from slippulse.model.layer_units import Layer
from slippulse.model.si_quantities import QUANTITIES
from slippulse.plotting.selection import spaced_indices
from slippulse.plotting.space_time import drawn_range
from slippulse.plotting.style import BLUE, GREY, ORANGE

FRAME_COUNT, FRAMES_PER_SECOND = 61, 12
DOTS_PER_INCH = 90
FIELDS = {
    "sample_velocity": (r"slip velocity $\dot u$", BLUE),
    "sample_slip": (r"slip $u$", ORANGE),
}


class Curve(NamedTuple):
    """A drawn line, and its values with one row for each sampled time."""

    line: Line2D
    values: np.ndarray


def save_animation(
    run: xr.Dataset, title: str, path: str | Path, layer: Layer | None = None
) -> None:
    """Write an animated GIF whose frames are evenly spread over the sampled times of a run.

    layer : if given, the axes are in SI units
    """
    figure = Figure(figsize=(6.4, 3.6), layout="constrained")
    curves = _draw_first_frame(figure, run, layer)
    times, unit_of_time = _drawn_values(run["sample_time"].values, "time", layer)
    frames = spaced_indices(times.size, FRAME_COUNT)
    clock = figure.suptitle("", fontsize=9.0)
    # A dollar sign in the title is a character, and does not begin a formula.
    plain_title = title.replace("$", r"\$")

    def draw(frame: int) -> None:
        """Draw one instant; ``frame`` is its index in the sampled times."""
        for curve in curves:
            curve.line.set_ydata(curve.values[frame])
        clock.set_text(rf"{plain_title}: $t = {times[frame]:.2f}$ {unit_of_time}".rstrip())

    # The layout is computed once, for the frame with the longest title. Otherwise the panels would
    # move from frame to frame.
    draw(int(frames[-1]))
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    animation = FuncAnimation(figure, draw, frames=frames)
    writer = PillowWriter(fps=FRAMES_PER_SECOND)
    write_whole(path, lambda file: animation.save(file, writer=writer, dpi=DOTS_PER_INCH))


def _draw_first_frame(figure: Figure, run: xr.Dataset, layer: Layer | None) -> list[Curve]:
    """Draw one panel for each of FIELDS, at the first sampled time, and return their curves."""
    lower, upper = drawn_range(run)
    positions = run["sample_position"].values
    is_in_range = (positions >= lower) & (positions <= upper)
    all_x, unit_of_x = _drawn_values(positions, "length", layer)
    x = all_x[is_in_range]
    panels = figure.subplots(2, 1, sharex=True)
    curves = []
    for axes, (name, (label, colour)) in zip(panels, FIELDS.items(), strict=True):
        values, unit = _drawn_values(run[name].values[:, is_in_range], QUANTITIES[name], layer)
        largest = np.nanmax(values)
        axes.axhline(0.0, color=GREY, linewidth=0.5)
        (line,) = axes.plot(x, values[0], color=colour)
        axes.set(ylabel=_with_unit(label, unit), ylim=(-0.04 * largest, 1.05 * largest))
        curves.append(Curve(line, values))
    # The range has no unit. With a layer, the outermost samples in it give the limits.
    limits = (lower, upper) if layer is None else (x[0], x[-1])
    panels[-1].set(xlim=limits, xlabel=_with_unit(r"position $x$", unit_of_x))
    return curves


def _with_unit(label: str, unit: str) -> str:
    """Return an axis label with its unit in parentheses, if it has a unit."""
    return f"{label} ({unit})" if unit else label


def _drawn_values(values: np.ndarray, quantity: str, layer: Layer | None) -> tuple[np.ndarray, str]:
    """Return values in the drawn unit, and this unit as text.

    quantity : physical quantity of the values, such as "length"
    layer : the layer in SI units; if it is None, values have no unit, and the text is empty
    """
    if layer is None:
        return values, ""
    numbers = layer.convert_to_si(values, quantity)
    unit = readable_unit(quantity, numbers)
    return numbers / unit.value, unit.text
