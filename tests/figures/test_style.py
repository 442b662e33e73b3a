"""How a figure is written."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib import colormaps
from matplotlib.colors import to_rgb
from PIL import Image
from pypdf import PdfReader
from tolerances import SHADE

from slippulse.data.origin import configured_by
from slippulse.figures.style import COLUMN, CYCLE, PAGE, VELOCITY_MAP, new_figure, save_figure

CONFIGURATION = "0123456789abcdef"


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A figure that has words and a formula, written by a job."""
    folder = tmp_path_factory.mktemp("style")
    figure = new_figure(COLUMN, 2.0)
    axes = figure.subplots()
    axes.set_xlabel("pre-stress AVATAR")
    axes.set_ylabel(r"$\tau_0$")
    with configured_by(CONFIGURATION):
        save_figure(figure, folder / "figure.png", folder / "figure.pdf")
    return folder


def test_words_of_a_figure_can_be_searched_for(folder):
    assert "pre-stress AVATAR" in PdfReader(folder / "figure.pdf").pages[0].extract_text()


def test_a_figure_says_by_which_configuration_it_was_made_and_nothing_else(folder):
    with Image.open(folder / "figure.png") as image:
        assert image.text == {"Comment": f"configuration {CONFIGURATION}"}
    assert dict(PdfReader(folder / "figure.pdf").metadata) == {"/Keywords": f"configuration {CONFIGURATION}"}


def test_a_figure_of_no_job_names_no_configuration(tmp_path):
    save_figure(new_figure(2.0, 1.0), tmp_path / "figure.png", tmp_path / "figure.pdf")
    with Image.open(tmp_path / "figure.png") as image:
        assert image.text == {}
    assert not PdfReader(tmp_path / "figure.pdf").metadata


def test_a_picture_keeps_the_colours_of_its_legend(tmp_path):
    """Small fills and whole maps, with steps too small to be seen."""
    figure = new_figure(PAGE, 2.0)
    lines, shades = figure.subplots(1, 2)
    for place, colour in enumerate(CYCLE):
        lines.plot([place], [0.0], "s", color=colour, markersize=6.0)
    shades.imshow(np.linspace(0.0, 1.0, 256)[None, :], aspect="auto", cmap=VELOCITY_MAP)
    save_figure(figure, tmp_path / "figure.png", tmp_path / "figure.pdf")
    with Image.open(tmp_path / "figure.png") as image:
        assert image.mode == "P" and image.width == PAGE * 300
        assert image.convert("RGB").getpixel((0, 0)) == (255, 255, 255)
        found = np.array([colour for _, colour in image.convert("RGB").getcolors(1 << 24)])
    for colour in CYCLE:
        assert np.abs(found - 255 * np.array(to_rgb(colour))).max(axis=1).min() < 1.0
    for colour in colormaps[VELOCITY_MAP](np.linspace(0.0, 1.0, 256)):
        assert np.abs(found - 255 * colour[:3]).max(axis=1).min() <= SHADE
