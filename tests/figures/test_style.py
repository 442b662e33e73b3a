"""How a figure is written."""

from pathlib import Path

import pytest
from PIL import Image
from pypdf import PdfReader

from slippulse.data.files import CONFIGURATION as VARIABLE
from slippulse.figures.style import COLUMN, new_figure, save_figure

CONFIGURATION = "0123456789abcdef"


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """A figure that has words and a formula, written by a job."""
    folder = tmp_path_factory.mktemp("style")
    figure = new_figure(COLUMN, 2.0)
    axes = figure.subplots()
    axes.set_xlabel("pre-stress AVATAR")
    axes.set_ylabel(r"$\tau_0$")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(VARIABLE, CONFIGURATION)
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
