"""Draw arrows and labels of a sketch."""

from typing import Any

from matplotlib.axes import Axes
from matplotlib.patches import FancyArrowPatch

from slippulse.plotting.style import BLACK, Look

Point = tuple[float, float]
# An arrow with a head at each end, for a dimension.
TWO_HEADS: Look = {"arrowstyle": "<|-|>"}
MUTED_GREY = "0.25"


def arrow(axes: Axes, start: Point, end: Point, colour: str, **look: Any) -> None:
    """Draw an arrow from start to end, which touches both points."""
    head: Look = {"arrowstyle": "-|>", "mutation_scale": 7.0, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.add_patch(FancyArrowPatch(start, end, color=colour, linewidth=1.0, **head | look))


def label(axes: Axes, x: float, y: float, text: str, colour: str = BLACK, **look: Any) -> None:
    """Write a text, centred unless ``look`` has another alignment."""
    centred: Look = {"ha": "center", "va": "center", "fontsize": 9.0}
    axes.text(x, y, text, color=colour, **centred | look)
