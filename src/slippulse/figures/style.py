"""The look of every figure, in one place."""

from __future__ import annotations

from pathlib import Path

import matplotlib
import matplotlib.mathtext
import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, LogNorm, Normalize
from matplotlib.figure import Figure

from ..data.files import write_whole
from ..data.origin import configuration
from .shared.png import save_png

# Widths of one and two columns of the journal, in inches.
COLUMN = 3.4
PAGE = 7.05

# Okabe and Ito's colours, which readers with any colour vision can tell apart.
BLUE, ORANGE, GREEN, PURPLE = "#0072B2", "#D55E00", "#009E73", "#CC79A7"
SKY, YELLOW, BLACK, GREY = "#56B4E9", "#E69F00", "#000000", "#7f7f7f"
CYCLE = (BLUE, ORANGE, GREEN, PURPLE, SKY, YELLOW, BLACK)
# Of each order of the localised scheme; the textbook scheme is black.
ORDER_COLOURS = {3: BLUE, 4: ORANGE, 5: GREEN, 6: PURPLE, 7: YELLOW, 8: SKY}
VELOCITY_MAP = "viridis"
# A quantity has the same colour for the same value in every figure: map, its part that is used, ends, and whether the
# scale is logarithmic.
SCALES = {
    "tau_0": ("plasma", (0.0, 0.88), (0.0, 1.0), False),
    "tau_l": ("YlGnBu_r", (0.0, 0.75), (-2.0, 0.0), False),
    "gamma": ("cividis", (0.0, 0.95), (1e-3, 1.0), True),
    "damping_ratio": ("viridis", (0.0, 0.92), (5e-3, 5.0), True),
    "width": ("YlOrBr", (0.35, 1.0), (0.5, 16.0), True),
}

# A Times, as the journal has, which Matplotlib brings along; the report has the same.
FAMILY = "STIXGeneral"
RC = {
    "font.size": 9.0,
    "axes.labelsize": 9.0,
    "axes.titlesize": 9.0,
    "xtick.labelsize": 8.0,
    "ytick.labelsize": 8.0,
    "legend.fontsize": 8.0,
    "legend.frameon": False,
    "legend.labelspacing": 0.2,
    "lines.linewidth": 1.1,
    "lines.markersize": 3.5,
    "axes.linewidth": 0.6,
    "axes.spines.top": True,
    "axes.spines.right": True,
    "xtick.direction": "in",
    "ytick.direction": "in",
    "font.family": [FAMILY, "DejaVu Sans"],
    "mathtext.fontset": "stix",
    "axes.prop_cycle": matplotlib.cycler(color=CYCLE),
    # The layout is found at the resolution of the PNG, which then meets its formulas already set.
    "figure.dpi": 300,
    "savefig.dpi": "figure",
    # Smaller files in half of the time that TrueType takes.
    "pdf.fonttype": 3,
    # Names of objects in a PDF would otherwise be random.
    "svg.hashsalt": "slippulse",
}
matplotlib.rcParams.update(RC)
# Scripts of a label of 7 points have 6, not 5. There is no public setting; a test looks at what is drawn.
SCRIPTS = 6.0 / 7.0
matplotlib.mathtext._mathtext.SHRINK_FACTOR = SCRIPTS


def new_figure(width: float, height: float) -> Figure:
    """An empty figure in the house style, ``width`` by ``height`` inches."""
    return Figure(figsize=(width, height), layout="constrained")


def colour_scale(quantity: str) -> ScalarMappable:
    """The colours of a quantity of SCALES; ``to_rgba`` gives that of a value, a colour bar shows all."""
    name, part, ends, logarithmic = SCALES[quantity]
    colours = matplotlib.colormaps[name](np.linspace(*part, 256))
    norm = (LogNorm if logarithmic else Normalize)(*ends, clip=True)
    return ScalarMappable(norm, ListedColormap(colours))


def panel_letter(axes, letter: str) -> None:
    """Mark a panel (a), (b), ... above its upper left corner."""
    axes.set_title(f"({letter})", loc="left", fontweight="bold", fontsize=9.0)


def save_figure(figure: Figure, png: str | Path, pdf: str | Path) -> None:
    """Write PNG and PDF with no clock in them; the layout is found once, which is most of the work."""
    figure.get_layout_engine().execute(figure)
    # With an engine, a mere stand-in too, each file would be drawn twice.
    figure.set_layout_engine(None)
    made_by = f"configuration {configuration()}" if configuration() else None
    vectors = {"CreationDate": None, "Creator": None, "Producer": None, "Keywords": made_by}
    save_png(figure, png, made_by)
    write_whole(pdf, lambda part: figure.savefig(part, format="pdf", metadata=vectors))
