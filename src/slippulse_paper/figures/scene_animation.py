"""A scene as an animation: slip velocity and slip over position, as time goes on."""

from pathlib import Path

import numpy as np
import xarray as xr
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.figure import Figure

from slippulse.data.files import write_whole
from slippulse.plotting.selection import spaced_indices
from slippulse.plotting.space_time import limits
from slippulse.plotting.style import BLUE, GREY, ORANGE

FRAMES, PER_SECOND = 61, 12
DOTS_PER_INCH = 90
FIELDS = {
    "sample_velocity": (r"slip velocity $\dot u$", BLUE),
    "sample_slip": (r"slip $u$", ORANGE),
}


def save_animation(run: xr.Dataset, title: str, path: str | Path) -> None:
    """Write an animated GIF of frames that are evenly spread over the samples of a run."""
    lower, upper = limits(run)
    x, times = run["sample_position"].values, run["sample_time"].values
    inside = (x >= lower) & (x <= upper)
    frames = spaced_indices(times.size, FRAMES)
    figure, lines = Figure(figsize=(6.4, 3.6), layout="constrained"), []
    panels = figure.subplots(2, 1, sharex=True)
    for axes, (name, (label, colour)) in zip(panels, FIELDS.items(), strict=True):
        values = run[name].values[:, inside]
        axes.axhline(0.0, color=GREY, linewidth=0.5)
        (line,) = axes.plot(x[inside], values[0], color=colour)
        axes.set(ylabel=label, ylim=(-0.04 * np.nanmax(values), 1.05 * np.nanmax(values)))
        lines.append((line, values))
    panels[1].set(xlim=(lower, upper), xlabel=r"position $x$")
    clock = figure.suptitle("", fontsize=9.0)
    plain = title.replace("$", r"\$")

    def draw(frame: int) -> None:
        for line, values in lines:
            line.set_ydata(values[frame])
        clock.set_text(rf"{plain}: $t = {times[frame]:.2f}$")

    # The layout is found once, for the longest title, and kept: the frames must not jump.
    draw(int(frames[-1]))
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    animation, writer = FuncAnimation(figure, draw, frames=frames), PillowWriter(fps=PER_SECOND)
    write_whole(path, lambda part: animation.save(part, writer=writer, dpi=DOTS_PER_INCH))
