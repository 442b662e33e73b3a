"""The style of every figure: sizes, colours, symbols, and functions that draw common parts."""

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from textwrap import fill
from typing import Any, NamedTuple, TypeAlias

import matplotlib
import matplotlib.rcsetup
import numpy as np
import pandas as pd
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, LogNorm, Normalize, PowerNorm
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patheffects import withStroke
from matplotlib.ticker import NullFormatter
from PIL import Image
from PIL.PngImagePlugin import PngInfo

from ..data.files import configuration_digest, write_whole
from ..model.scene import SCENE_NUMBERS

# Keyword arguments of Matplotlib that set colours, line widths and the like.
Look: TypeAlias = dict[str, Any]
# Left end, lower end, width and height of an inset, as fractions of its panel.
Box: TypeAlias = tuple[float, float, float, float]
# Widths of one and two columns of the journal, in inches.
COLUMN_WIDTH = 3.4
PAGE_WIDTH = 7.05

# Okabe and Ito's colours, which readers with any colour vision can tell apart.
BLUE, ORANGE = "#0072B2", "#D55E00"
GREEN, PURPLE = "#009E73", "#CC79A7"
SKY, YELLOW = "#56B4E9", "#E69F00"
BLACK, GREY = "#000000", "#7f7f7f"
COLOUR_CYCLE = (BLUE, ORANGE, GREEN, PURPLE, SKY, YELLOW, BLACK)
VELOCITY_MAP = "viridis"
MARKERS = ("o", "s", "^", "D", "v", "P")
# Symbols of parameters, by the name of their column.
SYMBOLS = {name: definition.symbol for name, definition in SCENE_NUMBERS.items()}
SYMBOLS |= {
    "tau_0": r"\tau_0",
    "left": r"\tau_{0,l}",
    "right": r"\tau_{0,r}",
    "width": "W",
    "damping_ratio": "b",
    "time": "t",
}
# Markers that are not filled, and the font size of the smallest text (in points).
OPEN_MARKER: Look = {"markerfacecolor": "white"}
SMALL_TEXT = 7.0
# Colour and marker of each regime of a rupture under another law of friction.
REGIMES = {
    "sticking pulse": (BLUE, "o"),
    "creeping pulse": (GREEN, "^"),
    "crack": (ORANGE, "s"),
    "no rupture": (GREY, "x"),
}
# Red, green, blue and opacity of a white pixel, one byte each.
WHITE_PIXEL = 0xFFFFFFFF
# White outline of text that is written on a drawing.
TEXT_OUTLINE = [withStroke(linewidth=2.2, foreground="white")]


class Scale(NamedTuple):
    """Colours of a quantity, which has the same colour for the same value in every figure."""

    colour_map: str
    first: float  # part of the colour map that can be seen on white
    last: float
    norm: Normalize


# The scale of `left` is stretched towards 0, where most levels are.
SCALES = {
    "tau_0": Scale("plasma", 0.0, 0.73, Normalize(0.0, 1.0, clip=True)),
    "left": Scale("YlGnBu_r", 0.0, 0.47, PowerNorm(2.0, -2.0, 0.0, clip=True)),
    "gamma": Scale("cividis", 0.0, 0.66, LogNorm(1e-3, 1.0, clip=True)),
    "damping_ratio": Scale("viridis", 0.0, 0.64, LogNorm(5e-3, 5.0, clip=True)),
    "width": Scale("copper_r", 0.36, 1.0, LogNorm(0.5, 16.0, clip=True)),
}
# Column of the level that decides the colour of a run, by boundary condition.
LEVEL_COLUMNS = {"displacement": "tau_0", "stress": "left"}
# A note below a figure: height of one line, height of the gap above the note (both in inches), and
# number of characters in one inch of a line.
NOTE_LINE_HEIGHT, NOTE_GAP = 0.13, 0.08
NOTE_CHARACTERS_PER_INCH = 22
# A font like the Times of the journal, which is part of Matplotlib. The report uses it, too.
FONT_FAMILY = "STIXGeneral"
RC_SETTINGS: dict[Any, Any] = {
    "font.size": 8.0,
    "axes.labelsize": 9.0,
    "axes.titlesize": 9.0,
    "figure.titlesize": 9.0,
    "figure.labelsize": 9.0,
    "legend.frameon": False,
    "legend.labelspacing": 0.2,
    "legend.columnspacing": 1.0,
    "legend.handlelength": 1.6,
    "legend.handletextpad": 0.6,
    "image.cmap": VELOCITY_MAP,
    "lines.linewidth": 1.0,
    "lines.markersize": 3.5,
    "lines.markeredgewidth": 0.7,
    "axes.linewidth": 0.6,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "font.family": [FONT_FAMILY, "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "axes.prop_cycle": matplotlib.rcsetup.cycler(color=COLOUR_CYCLE),
    # With a fixed height of titles, Matplotlib does not search for a free place. The search takes a
    # tenth of the time.
    "axes.titley": 1.0,
    # The title of a panel is on the right, and its letter on the left.
    "axes.titlelocation": "right",
    # The layout is made at the resolution of the PNG, so that formulas are typeset only once.
    "figure.dpi": 300,
    "savefig.dpi": "figure",
    # Type 3 fonts give smaller files than TrueType, in half of the time.
    "pdf.fonttype": 3,
    # Without this value, the names of objects in a file would be random.
    "svg.hashsalt": "slippulse",
}
# Only the fonts of Matplotlib are used, and the environment of the user does not change the date.
ENVIRONMENT = {"MPL_IGNORE_SYSTEM_FONTS": "1", "SOURCE_DATE_EPOCH": "0"}


@contextmanager
def house_style() -> Iterator[None]:
    """Make and save figures in the house style, whatever the settings of the user.

    Inside this context, Matplotlib has its own defaults with the changes in RC_SETTINGS. At the
    end, the settings and the environment of the caller are restored.
    """
    caller_environment = {name: os.environ.get(name) for name in ENVIRONMENT}
    with matplotlib.rc_context():
        os.environ.update(ENVIRONMENT)
        try:
            matplotlib.rcdefaults()
            matplotlib.rcParams.update(RC_SETTINGS)
            yield
        finally:
            for name, value in caller_environment.items():
                os.environ.pop(name)
                if value is not None:
                    os.environ[name] = value


def as_given(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Return the only one of the tables.

    A figure that draws the table of one study as it is uses this function as its `table`.
    """
    (only_table,) = tables.values()
    return only_table


def new_panels(
    width: float, height: float, letters: str, **options: Any
) -> tuple[Figure, list[Axes]]:
    """Return a figure and its panels, which are marked (a), (b), ...

    width, height : size of the figure in inches
    letters : arrangement of the panels in rows; "aab;ccc" puts a wide panel a and a narrow panel b
        above a panel c that is as wide as both
    options : arguments of `Figure.subplot_mosaic`
    """
    figure = Figure(figsize=(width, height), layout="constrained")
    panels = figure.subplot_mosaic(letters, **options)
    for letter, axes in panels.items():
        panel_letter(axes, letter)
    return figure, [*panels.values()]


def small_inset(axes: Axes, box: Box, title: str) -> Axes:
    """Add an inset with small text to a panel, and return its axes.

    box : left, bottom, width and height of the inset, as fractions of the panel
    """
    inset = axes.inset_axes(box)
    inset.tick_params(labelsize=SMALL_TEXT, length=1.5, pad=1.5)
    inset.set_title(title, loc="center", fontsize=SMALL_TEXT, pad=2.5)
    return inset


def few_ticks(axis: Axis, ticks: Sequence[float] | np.ndarray) -> None:
    """Set the ticks that have numbers. The minor ticks of a logarithmic axis have none."""
    axis.set_ticks(ticks, [f"{tick:g}" for tick in ticks])
    axis.set_minor_formatter(NullFormatter())


def colour_scale(quantity: str) -> ScalarMappable:
    """Return the colour scale of a quantity of SCALES.

    The scale can be drawn as a colour bar, and its method ``to_rgba`` converts values to colours.
    """
    scale = SCALES[quantity]
    colours = matplotlib.colormaps[scale.colour_map](np.linspace(scale.first, scale.last, 256))
    return ScalarMappable(scale.norm, ListedColormap(colours))


def colour(quantity: str, value: float | np.ndarray | pd.Series) -> np.ndarray:
    """Return the colour of a value of a quantity of SCALES, or one colour for each value."""
    return colour_scale(quantity).to_rgba(np.asarray(value))


def panel_letter(axes: Axes, letter: str) -> None:
    """Write the letter of a panel in brackets, such as (a), above its upper left corner."""
    axes.set_title(f"({letter})", loc="left", fontweight="bold")


def entry(label: str, **look: Any) -> Line2D:
    """Return an entry of a legend: a line, or, if the look has a marker, a marker without a line.

    look : keyword arguments of `Line2D`
    """
    if "marker" in look:
        look = {"linestyle": "none"} | look
    return Line2D([], [], label=label, **look)


def conditions(held: bool, **numbers: float) -> str:
    """Return a title with the boundary condition and parameters, such as "Gamma = 1, W = 2".

    held : True if the displacement is held on top
    numbers : parameters by their names in SYMBOLS
    """
    parts = [rf"$\Gamma = {int(held)}$"]
    parts += [f"${SYMBOLS[name]} = {value:g}$" for name, value in numbers.items()]
    return ", ".join(parts)


def by_role(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Split a table into one table for each value of its column role."""
    return {str(role): rows for role, rows in table.groupby("role")}


def draw_first_order(axes: Axes, spacings: pd.Series, slope: float, colour: str) -> None:
    """Draw the line error = slope * spacing on logarithmic axes, over the range of the spacings."""
    ends = spacings.agg(["min", "max"]).to_numpy()
    axes.plot(ends, slope * ends, ":", color=colour, linewidth=0.8, label="first order")
    axes.set(xscale="log", yscale="log", xlabel=r"spacing $\Delta x$")


def draw_regimes(axes: Axes, runs: pd.DataFrame, x: str, **look: Any) -> None:
    """Mark the regime of each run by colour and marker, with its pre-stress on the vertical axis.

    runs : table with the columns regime and level (the pre-stress), and the column ``x``
    x : the column on the horizontal axis
    look : further arguments of `Axes.plot`; a colour or a label replaces that of the regime
    """
    for regime, rows in runs.groupby("regime"):
        colour, marker = REGIMES[str(regime)]
        axes.plot(rows[x], rows["level"], marker, **{"color": colour, "label": regime} | look)


def legend_handles(panels: Sequence[Axes]) -> list[Artist]:
    """Return one artist for each label in the panels, for a legend that all panels share."""
    artist_by_label: dict[object, Artist] = {}
    for axes in panels:
        artists, labels = axes.get_legend_handles_labels()
        artist_by_label |= zip(labels, artists, strict=True)
    return list(artist_by_label.values())


def legend_above(figure: Figure, axes: Axes, **look: Any) -> None:
    """Place a legend in one line above all panels of a figure, with the labels of one panel."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels), **look)


def legend_below(figure: Figure, handles: Sequence[Artist], columns: int) -> None:
    """Place a legend below all panels of a figure.

    handles : one artist for each entry of the legend
    columns : number of columns of the legend
    """
    figure.legend(handles=handles, loc="outside lower center", ncols=columns)


def save_figure(figure: Figure, png: str | Path, pdf: str | Path, note: str = "") -> None:
    """Write a figure as PNG and PDF, without dates, and with an optional note below it."""
    if note:
        _add_note(figure, note)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    # The PDF has the layout of the PNG. With a layout engine it would be drawn twice.
    figure.set_layout_engine(None)
    source = f"configuration {configuration_digest()}" if configuration_digest() else None
    metadata = {"CreationDate": None, "Creator": None, "Producer": None, "Keywords": source}
    # A file gets its name only when it is complete.
    write_whole(png, lambda path: _save_png(canvas, path, source))
    write_whole(pdf, lambda path: figure.savefig(path, format="pdf", metadata=metadata))


def _add_note(figure: Figure, note: str) -> None:
    """Write a note below a figure, and make the figure higher by as much as the note needs."""
    width, height = figure.get_size_inches()
    text = fill(note, int(width * NOTE_CHARACTERS_PER_INCH))
    note_height = NOTE_GAP + NOTE_LINE_HEIGHT * (1 + text.count("\n"))
    figure.set_size_inches(width, height + note_height)
    bottom = note_height / (height + note_height)
    figure.set_layout_engine("constrained", rect=(0.0, bottom, 1.0, 1.0 - bottom))
    look: Look = {"ha": "right", "va": "bottom", "fontsize": SMALL_TEXT, "color": ORANGE}
    # A note may quote values of the user, in which a dollar sign does not begin a formula.
    figure.text(0.995, 0.005, text, parse_math=False, **look).set_in_layout(False)


def _save_png(canvas: FigureCanvasAgg, path: Path, source: str | None) -> None:
    """Write a PNG with a palette of 256 colours, the last of which is white.

    Such a file has a third of the bytes of a PNG with all colours, and a mean error below half a
    level.

    source : text that is written into the file as a comment
    """
    comments, dpi = PngInfo(), canvas.figure.dpi
    if source:
        comments.add_text("Comment", source)
    pixels = np.asarray(canvas.buffer_rgba())
    # Most pixels are white. Without them, the 255 other colours are found in half of the time. The
    # four bytes of a pixel are compared as one integer.
    is_coloured = pixels.view(np.uint32)[..., 0] != WHITE_PIXEL
    # All coloured pixels stand in one row.
    coloured = Image.fromarray(pixels[np.newaxis, is_coloured]).convert("RGB")
    reduced = coloured.quantize(255, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    colour_numbers = np.full(is_coloured.shape, 255, dtype=np.uint8)
    colour_numbers[is_coloured] = np.asarray(reduced)[0]
    picture = Image.fromarray(colour_numbers).convert("P")
    # The palette has red, green and blue of each colour. Unused entries become white.
    palette = reduced.getpalette() or []
    picture.putpalette(palette + [255] * (3 * 256 - len(palette)))
    picture.save(path, format="png", dpi=(dpi, dpi), pnginfo=comments)
