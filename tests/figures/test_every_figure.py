"""What holds for every figure: it draws from its table, its axes are labelled, it fits the journal."""

from __future__ import annotations

import re
from pathlib import Path

import matplotlib
import numpy as np
import pytest
from matplotlib.legend import Legend
from matplotlib.mathtext import MathTextParser
from matplotlib.text import Text

from slippulse.figures.style import PAGE, SCRIPTS, save_figure
from slippulse.report.texts import read_captions

MODULES = Path(__file__).parents[2] / "src/slippulse/figures"
NAMES = sorted(path.stem for pattern in ("fig*.py", "study*.py") for path in MODULES.glob(pattern))
# The figures of the paper, and among the slow tests the studies.
DRAWN = [pytest.param(name, marks=() if name.startswith("fig") else pytest.mark.slow) for name in NAMES]
# Points, at the width of the journal.
SMALLEST = 6.0
SKETCHES = {"fig01_system_sketch", "fig06_burridge_knopoff", "fig07_damage_zone", "study_extremes"}


def test_there_is_a_module_for_every_figure_of_the_paper():
    assert sum(name.startswith("fig") for name in NAMES) == 11


@pytest.mark.parametrize("name", NAMES)
def test_it_has_a_caption(project, name):
    caption = read_captions(project / "manuscript/captions.yaml")[name]
    assert len(caption.caption.split()) > 20


@pytest.mark.parametrize("name", DRAWN)
def test_it_fits_a_page(draw, name):
    width, height = draw(name).figure.get_size_inches()
    assert width <= PAGE + 1e-9 and height <= 9.0


@pytest.mark.parametrize("name", [drawn for drawn in DRAWN if drawn.values[0] not in SKETCHES])
def test_axes_with_data_are_labelled(draw, name):
    figure = draw(name).figure
    labels = [axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes] + [
        figure.get_supxlabel() + figure.get_supylabel()
    ]
    assert sum(bool(label) for label in labels) >= 2
    for axes in figure.axes:
        for line in axes.lines:
            assert len(line.get_xdata()) == len(line.get_ydata())


@pytest.mark.parametrize("name", DRAWN)
def test_what_is_drawn_is_finite_and_written(draw, tmp_path, name):
    drawn = draw(name)
    assert len(drawn.table) > 0
    # The resolution is not what is tested, and takes most of the time.
    with matplotlib.rc_context({"savefig.dpi": 50}):
        save_figure(drawn.figure, tmp_path / "first.png", tmp_path / "first.pdf")
    for ending in ("png", "pdf"):
        assert (tmp_path / f"first.{ending}").stat().st_size > 5000
    numbers = drawn.table.select_dtypes("number").to_numpy()
    assert not np.isinf(numbers).any()
    assert not too_small(drawn.figure)
    assert not cut_off(drawn.figure)


def too_small(figure) -> dict[str, float]:
    """Texts of a figure, as it was drawn, that are too small to read in print."""
    found = {}
    for text in figure.findobj(Text):
        shown = text.get_text()
        if text.get_visible() and shown.strip():
            size = text.get_fontsize() * (SCRIPTS if re.search(r"\$[^$]*[_^]", shown) else 1.0)
            if size < SMALLEST - 1e-9:
                found[shown] = round(size, 2)
    return found


def cut_off(figure) -> list[list[str]]:
    """Legends of a figure that do not end within it."""
    page = figure.bbox.padded(1.0)
    return [
        [text.get_text() for text in legend.get_texts()]
        for legend in figure.findobj(Legend)
        if page.count_contains(legend.get_window_extent().get_points()) < 2
    ]


def test_exponents_have_the_size_that_they_are_given():
    letter, exponent = MathTextParser("path").parse("$x^2$").glyphs
    assert exponent[1] / letter[1] == pytest.approx(SCRIPTS)


@pytest.mark.parametrize("name", ["fig03_steady_state", pytest.param("study_arrest", marks=pytest.mark.slow)])
def test_equal_tables_give_equal_bytes(draw, tmp_path, name):
    drawn = draw(name)
    with matplotlib.rc_context({"savefig.dpi": 50}):
        for take in ("first", "again"):
            save_figure(drawn.module.plot(drawn.table), tmp_path / f"{take}.png", tmp_path / f"{take}.pdf")
    for ending in ("png", "pdf"):
        assert (tmp_path / f"first.{ending}").read_bytes() == (tmp_path / f"again.{ending}").read_bytes()
