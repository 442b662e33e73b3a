"""Files of a figure, and colours that readers with any colour vision can tell apart.

Colour vision is simulated after Machado et al. (2009).
"""

import os
import subprocess
import sys
from dataclasses import replace
from itertools import combinations

import matplotlib
import numpy as np
import pytest
from matplotlib import font_manager
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from PIL import Image
from pypdf import PdfReader

from slippulse.data.files import CONFIGURATION_VARIABLE
from slippulse.plotting import style
from slippulse.plotting.style import (
    COLOUR_CYCLE,
    COLUMN_WIDTH,
    FONT_FAMILY,
    PAGE_WIDTH,
    SCALES,
    colour_scale,
)
from slippulse_paper.figures.fig06_burridge_knopoff import STATE_COLOURS
from slippulse_paper.steps import draw_figure

# Rows of linear red, green, blue.
VISION = {
    "usual": np.eye(3),
    "deuteranopia": [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]],
    "protanopia": [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]],
    "tritanopia": [[1.256, -0.077, -0.179], [-0.078, 0.931, 0.148], [0.005, 0.691, 0.304]],
    "grey": np.tile([0.2126, 0.7152, 0.0722], (3, 1)),
}
TO_XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
WHITE = TO_XYZ.sum(axis=1)
# Distances in CIE L*a*b*: what is just seen is about 2; marks of a few points need more.
APART, GREYS_APART = 10.0, 15.0
# The palest level that a figure draws as a line or a mark.
PALEST = {"tau_0": 0.8, "left": -0.1, "gamma": 0.65, "damping_ratio": 3.0, "width": 0.5}


def linear(colour) -> np.ndarray:
    rgb = np.array(to_rgb(colour))
    return np.where(rgb <= 0.04045, rgb / 12.92, ((rgb + 0.055) / 1.055) ** 2.4)


def lab(colour, vision: str) -> np.ndarray:
    """Return L*, a*, b* of a colour as readers with a colour vision deficiency see it."""
    xyz = TO_XYZ @ np.clip(VISION[vision] @ linear(colour), 0.0, 1.0) / WHITE
    f = np.where(xyz > 0.008856, np.cbrt(xyz), 7.787 * xyz + 16.0 / 116.0)
    return np.array([116.0 * f[1] - 16.0, 500.0 * (f[0] - f[1]), 200.0 * (f[1] - f[2])])


@pytest.mark.parametrize("vision", ["usual", "deuteranopia", "protanopia"])
def test_colours_of_the_cycle_are_apart(vision):
    for one, other in combinations([lab(colour, vision) for colour in COLOUR_CYCLE], 2):
        assert np.linalg.norm(one - other) > APART


@pytest.mark.parametrize(("quantity", "value"), PALEST.items())
def test_levels_are_seen_on_white(quantity, value):
    luminance = VISION["grey"][0] @ linear(colour_scale(quantity).to_rgba(value))
    assert 1.05 / (luminance + 0.05) >= 3.0


@pytest.mark.parametrize("vision", VISION)
@pytest.mark.parametrize("quantity", SCALES)
def test_a_scale_goes_one_way_in_lightness(quantity, vision):
    norm = SCALES[quantity].norm
    colours = colour_scale(quantity).to_rgba(norm.inverse(np.linspace(0.0, 1.0, 9)))
    lightness = [lab(colour, vision)[0] for colour in colours]
    steps = np.diff(lightness)
    assert (steps > 0.0).all() or (steps < 0.0).all()
    assert abs(lightness[-1] - lightness[0]) > 40.0


def test_states_of_a_block_are_apart_in_grey():
    shades = sorted(lab(colour, "grey")[0] for colour in STATE_COLOURS.values())
    assert (np.diff(shades) > GREYS_APART).all()


@pytest.mark.parametrize("configuration", ["0123456789abcdef", ""])
def test_a_figure_names_its_configuration_alone_and_has_words(configuration, tmp_path, monkeypatch):
    """A figure that no job made has no configuration."""
    monkeypatch.setenv(CONFIGURATION_VARIABLE, configuration)
    figure, (axes,) = style.new_panels(COLUMN_WIDTH, 2.0, "a")
    axes.set(xlabel="pre-stress AVATAR", ylabel=r"$\tau_0$")
    style.save_figure(figure, tmp_path / "figure.png", tmp_path / "figure.pdf")
    said = f"configuration {configuration}" if configuration else ""
    with Image.open(tmp_path / "figure.png") as image:
        assert image.text == ({"Comment": said} if said else {})
    pdf = PdfReader(tmp_path / "figure.pdf")
    assert dict(pdf.metadata or {}) == ({"/Keywords": said} if said else {})
    assert "pre-stress AVATAR" in pdf.pages[0].extract_text()


def test_a_png_of_few_colours_shows_them_exactly(tmp_path):
    figure = Figure(figsize=(1.0, 1.0))
    for left, colour in ((0.1, style.BLUE), (0.6, style.ORANGE)):
        figure.add_artist(Rectangle((left, 0.2), 0.3, 0.5, color=colour, antialiased=False))
    style.save_figure(figure, tmp_path / "figure.png", tmp_path / "figure.pdf")
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    with Image.open(tmp_path / "figure.png") as image:
        shown = np.asarray(image.convert("RGB"))
    np.testing.assert_array_equal(shown, np.asarray(canvas.buffer_rgba())[..., :3])
    assert len(np.unique(shown.reshape(-1, 3), axis=0)) == 3


def test_a_note_is_written_below_the_legend_of_a_figure(tmp_path):
    figure, (axes,) = style.new_panels(PAGE_WIDTH, 2.0, "a")
    axes.set(xlabel="position")
    (line,) = axes.plot([0.0, 1.0], label="a long text of a legend that is as wide as the figure")
    style.legend_below(figure, [line, line, line], columns=3)
    note = "altered: gamma = 0.3, and some other keys of the configuration"
    style.save_figure(figure, tmp_path / "figure.png", tmp_path / "figure.pdf", note)
    figure.draw_without_rendering()
    (legend,), (text,) = figure.legends, figure.texts
    below = [part.get_window_extent() for part in (axes.xaxis.label, legend, text)]
    assert below[0].y0 >= below[1].y1 and below[1].y0 >= below[2].y1


def test_a_job_draws_in_the_house_style_and_leaves_settings_around_it(tmp_path):
    outputs = {ending: tmp_path / f"sketch.{ending}" for ending in ("csv", "png", "pdf")}
    settings = {"figure": "fig01_system_sketch", "altered": ""}
    settings["values"] = {"strip_width": 0.1}
    with matplotlib.rc_context():
        # The defaults of Matplotlib are what is left where a module is imported in a context.
        matplotlib.rcdefaults()
        draw_figure.run({}, outputs, settings)
        assert matplotlib.rcParams["font.family"] != [FONT_FAMILY, "DejaVu Sans"]
    with Image.open(outputs["png"]) as picture:
        assert picture.info["dpi"] == pytest.approx((300.0, 300.0), abs=0.1)
    fonts = PdfReader(outputs["pdf"]).pages[0]["/Resources"]["/Font"].values()
    assert any(FONT_FAMILY in font.get_object().get("/BaseFont", font) for font in fonts)


def test_settings_fonts_and_dates_of_the_user_change_no_byte_of_a_figure(tmp_path, monkeypatch):
    def written(name: str) -> list[bytes]:
        paths = [tmp_path / f"{name}.{ending}" for ending in ("png", "pdf")]
        with style.house_style():
            figure, (axes,) = style.new_panels(COLUMN_WIDTH, 2.0, "a")
            axes.plot([0.0, 1.5], [0.0, 1e4], label=r"$\tau_0$")
            axes.set(xlabel="position", title="costs $5")
            style.save_figure(figure, *paths, "altered: published.a.statement = $\\frac{1}{$")
        return [path.read_bytes() for path in paths]

    expected = written("defaults")
    theirs = {"text.usetex": True, "axes.grid": True, "lines.linestyle": ":", "figure.dpi": 50.0}
    theirs |= {"font.family": "monospace", "pdf.compression": 0, "axes.formatter.use_locale": True}
    theirs |= {"savefig.bbox": "tight", "axes.xmargin": 0.5, "path.sketch": (1.0, 100.0, 2.0)}
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "")
    with matplotlib.rc_context(theirs):
        # A font of the user that has the name of ours.
        fonts = font_manager.fontManager
        other = replace(fonts.ttflist[0], fname=str(tmp_path / "none.ttf"), name=FONT_FAMILY)
        monkeypatch.setattr(fonts, "ttflist", [replace(other, weight=400), *fonts.ttflist])
        assert written("theirs") == expected
        assert matplotlib.rcParams["text.usetex"] and os.environ["SOURCE_DATE_EPOCH"] == ""


def test_the_libraries_of_jobs_load_whatever_the_user_has_set(tmp_path):
    (tmp_path / "matplotlibrc").write_bytes(b"text.usetex: True\nbackend: none\n\xff\xfe")
    theirs = {"MPLCONFIGDIR": str(tmp_path), "MPLBACKEND": "none", "SOURCE_DATE_EPOCH": ""}
    program = "import slippulse_paper.steps.worker_libraries, matplotlib\n"
    program += "assert not matplotlib.rcParams['text.usetex']"
    command = [sys.executable, "-W", "error", "-c", program]
    subprocess.run(command, env=os.environ | theirs, check=True)
