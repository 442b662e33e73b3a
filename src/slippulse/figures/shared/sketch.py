"""Arrows and labels of a sketch."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch
from matplotlib.text import Text

from ..style import BLACK, Look

Point = tuple[float, float]
# The style of an arrow with two heads, as a dimension has them.
BOTH = "<|-|>"
MUTED = "0.25"


def arrow(
    axes: Axes, start: Point, end: Point, colour: str, style: str = "-|>", gid: str | None = None
) -> None:
    """Draw an arrow that touches both points; ``style`` BOTH gives it two heads."""
    look: Look = {"mutation_scale": 7.0, "linewidth": 1.0, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.add_patch(FancyArrowPatch(start, end, arrowstyle=style, color=colour, gid=gid, **look))


def label(axes: Axes, x: float, y: float, text: str, colour: str = BLACK, **look: Any) -> Text:
    """Write a text, centred unless ``look`` says otherwise."""
    return axes.text(x, y, text, color=colour, **{"ha": "center", "va": "center"} | look)
