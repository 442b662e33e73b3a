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
    chosen = np.empty((COLOURS, 3), dtype=np.int16)
    count = 0
    for _, colour in found:
        if np.abs(chosen[:count] - colour).max(axis=1).min(initial=APART) >= APART:
            chosen[count] = colour
            count += 1
            if count == COLOURS:
                break
    palette = Image.new("P", (1, 1))
    palette.putpalette(chosen[:count].astype(np.uint8).tobytes())
    return picture.quantize(palette=palette, dither=Image.Dither.NONE)
