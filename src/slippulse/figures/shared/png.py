"""PNGs of figures with a palette, a third of the size of full colour."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image, PngImagePlugin

from ...data.files import write_whole

# As many colours as a palette has, each so far from the others that their steps are not seen in a colour map.
COLOURS, APART = 256, 4


def save_png(figure: Figure, path: str | Path, comment: str | None = None) -> None:
    """Write a figure at its own resolution, with no clock in it.

    Parameters
    ----------
    figure : opaque
    path : the file
    comment : noted in it
    """
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    size = canvas.get_width_height()
    picture = with_palette(Image.frombuffer("RGBA", size, canvas.buffer_rgba()).convert("RGB"))
    notes = PngImagePlugin.PngInfo()
    if comment:
        notes.add_text("Comment", comment)
    resolution = (figure.dpi, figure.dpi)
    write_whole(path, lambda part: picture.save(part, format="PNG", dpi=resolution, pnginfo=notes))


def with_palette(picture: Image.Image) -> Image.Image:
    """A picture in full colour with its most frequent colours, unchanged, and for each other one the nearest of them.

    Fills, maps and lines keep theirs, so that they are those of the legend; what changes is the rim between two.
    Palettes that average, as those of Pillow, change small fills or cut maps into bands.
    """
    found = sorted(picture.getcolors(picture.width * picture.height), key=lambda entry: (-entry[0], entry[1]))
    colours = np.array([colour for _, colour in found])
    chosen = np.empty((COLOURS, 3), dtype=int)
    count = 0
    for colour in colours:
        if np.abs(chosen[:count] - colour).max(axis=1).min(initial=APART) >= APART:
            chosen[count] = colour
            count += 1
            if count == COLOURS:
                break
    chosen = chosen[:count]
    # The nearest by |a - b|^2 = |a|^2 - 2 a b + |b|^2; Pillow's own search is for the nearest of a coarser colour.
    nearest = (np.sum(chosen**2, axis=1) - 2.0 * colours @ chosen.T).argmin(axis=1)
    index = np.zeros(1 << 24, dtype=np.uint8)
    index[_packed(colours)] = nearest
    out = Image.fromarray(index[_packed(np.asarray(picture))])
    out.putpalette(chosen.astype(np.uint8).tobytes())
    return out


def _packed(colours: np.ndarray) -> np.ndarray:
    """Each colour as one number."""
    return colours.astype(np.int32) @ np.array([1 << 16, 1 << 8, 1], dtype=np.int32)
