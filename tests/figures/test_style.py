"""How a figure is written."""

from __future__ import annotations

from io import BytesIO

import pytest
from fontTools.ttLib import TTFont
from pypdf import PdfReader

from slippulse.figures.style import COLUMN, new_figure, save_figure


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """A page with a figure that has words and a formula."""
    folder = tmp_path_factory.mktemp("style")
    figure = new_figure(COLUMN, 2.0)
    axes = figure.subplots()
    axes.set_xlabel("pre-stress AVATAR")
    axes.set_ylabel(r"$\bar\tau_0$")
    save_figure(figure, folder / "figure.png", folder / "figure.pdf")
    return PdfReader(folder / "figure.pdf").pages[0]


def test_words_of_a_figure_can_be_searched_for(page):
    assert "pre-stress AVATAR" in page.extract_text()


def test_fonts_of_a_figure_hold_outlines_and_no_rules_for_joining_letters(page):
    """Where each letter goes is written out; a new matplotlib may choose otherwise what it embeds."""
    fonts = [font.get_object() for font in page["/Resources"]["/Font"].values()]
    assert fonts
    for font in fonts:
        descriptor = font["/DescendantFonts"][0]["/FontDescriptor"]
        tables = set(TTFont(BytesIO(descriptor["/FontFile2"].get_data())).keys())
        assert "glyf" in tables
        assert not tables & {"GDEF", "GPOS", "GSUB"}
