"""The look of every figure, in one place."""

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from textwrap import fill
from typing import Any, TypeAlias

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

from ..data.files import configuration, write_whole
from ..model.scene import SCENE_NUMBERS

# Keywords of Matplotlib that say how a thing is drawn.
Look: TypeAlias = dict[str, Any]
# Left and lower end, width and height of an inset, as fractions of its panel.
Box: TypeAlias = tuple[float, float, float, float]
# Widths of one and two columns of the journal, in inches.
COLUMN = 3.4
PAGE = 7.05

# Okabe and Ito's colours, which readers with any colour vision can tell apart.
BLUE, ORANGE = "#0072B2", "#D55E00"
GREEN, PURPLE = "#009E73", "#CC79A7"
SKY, YELLOW = "#56B4E9", "#E69F00"
BLACK, GREY = "#000000", "#7f7f7f"
CYCLE = (BLUE, ORANGE, GREEN, PURPLE, SKY, YELLOW, BLACK)
VELOCITY_MAP = "viridis"
MARKERS = ("o", "s", "^", "D", "v", "P")
# Symbols of parameters, by their column.
SYMBOLS = {name: definition.symbol for name, definition in SCENE_NUMBERS.items()}
SYMBOLS |= {
    "tau_0": r"\tau_0",
    "left": r"\tau_{0,l}",
    "right": r"\tau_{0,r}",
    "width": "W",
    "damping_ratio": "b",
    "time": "t",
}
# Open markers, and the size of the smallest text.
OPEN: Look = {"markerfacecolor": "white"}
SMALL = 7.0
# Colour and marker of what a rupture under another friction turns into.
REGIMES = {
    "sticking pulse": (BLUE, "o"),
    "creeping pulse": (GREEN, "^"),
    "crack": (ORANGE, "s"),
    "no rupture": (GREY, "x"),
}
# Red, green, blue and opacity of a white pixel, one byte each.
WHITE_PIXEL = 0xFFFFFFFF
# The outline of letters that stand on a drawing.
HALO = [withStroke(linewidth=2.2, foreground="white")]


# A quantity has the same colour for the same value in every figure: a map, the part of it that is
# seen on white, and a norm. That of left is stretched towards 0, where most levels are.
SCALES: dict[str, tuple[str, float, float, Normalize]] = {
    "tau_0": ("plasma", 0.0, 0.73, Normalize(0.0, 1.0, clip=True)),
    "left": ("YlGnBu_r", 0.0, 0.47, PowerNorm(2.0, -2.0, 0.0, clip=True)),
    "gamma": ("cividis", 0.0, 0.66, LogNorm(1e-3, 1.0, clip=True)),
    "damping_ratio": ("viridis", 0.0, 0.64, LogNorm(5e-3, 5.0, clip=True)),
    "width": ("copper_r", 0.36, 1.0, LogNorm(0.5, 16.0, clip=True)),
}
# Each run has the colour of its level.
LEVEL = {"displacement": "tau_0", "stress": "left"}
# A note below a figure: inches of a line and of the gap above, and characters an inch.
NOTE_LINE, NOTE_GAP = 0.13, 0.08
NOTE_DENSITY = 22
# The Times that Matplotlib brings along, for the journal's; the report has it too.
FAMILY = "STIXGeneral"
RC: dict[Any, Any] = {
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
    "font.family": [FAMILY, "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "axes.prop_cycle": matplotlib.rcsetup.cycler(color=CYCLE),
    # A fixed height of titles; a search for what they might cover takes a tenth of the time.
    "axes.titley": 1.0,
    # The scene of a panel stands on the right; its letter is on the left.
    "axes.titlelocation": "right",
    # The layout is found at the resolution of the PNG, so that the formulas are set once.
    "figure.dpi": 300,
    "savefig.dpi": "figure",
    # Type 3 fonts give smaller files in half of the time that TrueType takes.
    "pdf.fonttype": 3,
    # Names of objects in a PDF would otherwise be random.
    "svg.hashsalt": "slippulse",
}
# Only the fonts that Matplotlib brings along are used, and no variable of the user gives a date.
ENVIRONMENT = {"MPL_IGNORE_SYSTEM_FONTS": "1", "SOURCE_DATE_EPOCH": "0"}


@contextmanager
def house_style() -> Iterator[None]:
    """Make and save figures in the house style, whatever the settings of the user.

    It starts from Matplotlib's own defaults, and restores the settings of the caller at its end.
    """
    before = {name: os.environ.get(name) for name in ENVIRONMENT}
    with matplotlib.rc_context():
        os.environ.update(ENVIRONMENT)
        try:
            matplotlib.rcdefaults()
            matplotlib.rcParams.update(RC)
            yield
        finally:
            for name, value in before.items():
                os.environ.pop(name)
                if value is not None:
                    os.environ[name] = value


def as_given(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Return the only table given; the `table` of a figure that draws one study as it is."""
    (table,) = tables.values()
    return table


def new_panels(
    width: float, height: float, letters: str, **options: Any
) -> tuple[Figure, list[Axes]]:
    """Make a figure with lettered panels, as wide as in rows of letters such as "aab;ccc"."""
    figure = Figure(figsize=(width, height), layout="constrained")
    panels = figure.subplot_mosaic(letters, **options)
    for letter, axes in panels.items():
        panel_letter(axes, letter)
    return figure, [*panels.values()]


def small_inset(axes: Axes, box: Box, title: str) -> Axes:
    """Add an inset with small letters in a box of a panel."""
    inset = axes.inset_axes(box)
    inset.tick_params(labelsize=SMALL, length=1.5, pad=1.5)
    inset.set_title(title, loc="center", fontsize=SMALL, pad=2.5)
    return inset


def few_ticks(axis: Axis, ticks: Sequence[float] | np.ndarray) -> None:
    """Set the only ticks with numbers, on a logarithmic axis too."""
    axis.set_ticks(ticks, [f"{tick:g}" for tick in ticks])
    axis.set_minor_formatter(NullFormatter())


def colour_scale(quantity: str) -> ScalarMappable:
    """Colours of a quantity of SCALES; ``to_rgba`` gives that of a value, a colour bar all."""
    name, first, last, norm = SCALES[quantity]
    colours = matplotlib.colormaps[name](np.linspace(first, last, 256))
    return ScalarMappable(norm, ListedColormap(colours))


def colour(quantity: str, value: float | np.ndarray | pd.Series) -> np.ndarray:
    """The colour of a value of a quantity of SCALES, or of each of several."""
    return colour_scale(quantity).to_rgba(np.asarray(value))


def panel_letter(axes: Axes, letter: str) -> None:
    """Mark a panel by (a), (b), ... above its upper left corner."""
    axes.set_title(f"({letter})", loc="left", fontweight="bold")


def entry(label: str, **look: Any) -> Line2D:
    """Make an entry of a legend: a line, or a marker without a line."""
    if "marker" in look:
        look = {"linestyle": "none"} | look
    return Line2D([], [], label=label, **look)


def conditions(held: bool, **numbers: float) -> str:
    """Title that names the boundary condition, and parameters by the names of SYMBOLS."""
    parts = [rf"$\Gamma = {int(held)}$"]
    parts += [f"${SYMBOLS[name]} = {value:g}$" for name, value in numbers.items()]
    return ", ".join(parts)


def by_role(table: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Split a table by its column role."""
    return {str(role): rows for role, rows in table.groupby("role")}


def draw_first_order(axes: Axes, spacings: pd.Series, slope: float, colour: str) -> None:
    """Draw an error in proportion to the spacing, on logarithmic axes."""
    ends = spacings.agg(["min", "max"]).to_numpy()
    axes.plot(ends, slope * ends, ":", color=colour, linewidth=0.8, label="first order")
    axes.set(xscale="log", yscale="log", xlabel=r"spacing $\Delta x$")


def draw_regimes(axes: Axes, runs: pd.DataFrame, x: str, **look: Any) -> None:
    """Mark the regime of each run over a column and the level."""
    for regime, rows in runs.groupby("regime"):
        colour, marker = REGIMES[str(regime)]
        axes.plot(rows[x], rows["level"], marker, **{"color": colour, "label": regime} | look)


def labelled(panels: Sequence[Axes]) -> list[Artist]:
    """Artists that have a label in any of some panels, one a label."""
    handles: dict[object, Artist] = {}
    for axes in panels:
        handles |= {artist.get_label(): artist for artist in axes.get_legend_handles_labels()[0]}
    return list(handles.values())


def legend_above(figure: Figure, axes: Axes, **look: Any) -> None:
    """Place one legend above all panels, with the labels of one of them."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside upper center", ncols=len(labels), **look)


def legend_below(figure: Figure, handles: Sequence[Artist], columns: int) -> None:
    """Place one legend below all panels."""
    figure.legend(handles=handles, loc="outside lower center", ncols=columns)


def save_figure(figure: Figure, png: str | Path, pdf: str | Path, note: str = "") -> None:
    """Write PNG and PDF with no clock in them, and below the figure what ``note`` has to say."""
    if note:
        width, height = figure.get_size_inches()
        text = fill(note, int(width * NOTE_DENSITY))
        added = NOTE_GAP + NOTE_LINE * (1 + text.count("\n"))
        figure.set_size_inches(width, height + added)
        bottom = added / (height + added)
        figure.set_layout_engine("constrained", rect=(0.0, bottom, 1.0, 1.0 - bottom))
        look: Look = {"ha": "right", "va": "bottom", "fontsize": SMALL, "color": ORANGE}
        # A note names values of the user, whose dollars begin no formula.
        figure.text(0.995, 0.005, text, parse_math=False, **look).set_in_layout(False)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    # The layout is that of the PNG: with an engine the PDF would be drawn twice.
    figure.set_layout_engine(None)
    made_by = f"configuration {configuration()}" if configuration() else None
    vectors = {"CreationDate": None, "Creator": None, "Producer": None, "Keywords": made_by}
    write_whole(png, lambda part: _save_png(canvas, part, made_by))
    write_whole(pdf, lambda part: figure.savefig(part, format="pdf", metadata=vectors))


def _save_png(canvas: FigureCanvasAgg, path: Path, made_by: str | None) -> None:
    """Write a PNG of 256 colours: a third of the bytes, and a mean error below half a level."""
    text, dpi = PngInfo(), canvas.figure.dpi
    if made_by:
        text.add_text("Comment", made_by)
    pixels = np.asarray(canvas.buffer_rgba())
    # Most pixels are white. Without them, the 255 other colours are found in half of the time.
    inked = pixels.view(np.uint32)[..., 0] != WHITE_PIXEL
    ink = Image.fromarray(pixels[np.newaxis, inked]).convert("RGB")
    reduced = ink.quantize(255, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    numbers = np.full(inked.shape, 255, dtype=np.uint8)
    numbers[inked] = np.asarray(reduced)[0]
    picture, palette = Image.fromarray(numbers).convert("P"), reduced.getpalette() or []
    picture.putpalette(palette + [255] * (3 * 256 - len(palette)))
    picture.save(path, format="png", dpi=(dpi, dpi), pnginfo=text)
