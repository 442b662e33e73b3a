"""Arrows and words of a sketch."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch
from matplotlib.text import Text

from ..style import BLACK, Look

Point = tuple[float, float]
BOTH = "<|-|>"


def arrow(
    axes: Axes, start: Point, end: Point, colour: str, style: str = "-|>", gid: str | None = None
) -> None:
    """An arrow from one point to another, which it touches; of a dimension it has two heads, BOTH."""
    look: Look = {"mutation_scale": 7.0, "linewidth": 1.0, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.add_patch(FancyArrowPatch(start, end, arrowstyle=style, color=colour, gid=gid, **look))


def label(axes: Axes, x: float, y: float, text: str, colour: str = BLACK, **look: Any) -> Text:
    """A word, centred if nothing else is said."""
    return axes.text(x, y, text, color=colour, **{"ha": "center", "va": "center"} | look)
