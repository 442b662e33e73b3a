"""The report as a reader gets it: whole, self-contained, the same bytes each time, with the numbers of its run."""

from __future__ import annotations

import copy
import json
import re
from base64 import b64decode
from html.parser import HTMLParser
from io import BytesIO
from types import SimpleNamespace

import pytest
import yaml
from PIL import Image
from pypdf import PdfReader
from slippulse.report.captions import read_captions
from slippulse.report.execute import execute

from slippulse.claims.reading import measured_text
from slippulse.data.numerals import with_uncertainty
from slippulse.figures.style import FAMILY


class Resources(HTMLParser):
    """What a browser would load, and which tags there are."""

    LOADING = frozenset({"src", "srcset", "data", "poster", "background", "action"})

    def __init__(self) -> None:
        super().__init__()
        self.loaded, self.tags = [], {}

    def handle_starttag(self, tag, attributes):
        self.tags[tag] = self.tags.get(tag, 0) + 1
        for key, value in attributes:
            if key in self.LOADING or (key in ("href", "xlink:href") and tag != "a"):
                self.loaded.append(value)


@pytest.fixture(scope="module")
def html(report) -> str:
    return report.html.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def pdf_text(report) -> str:
    return " ".join(page.extract_text() for page in PdfReader(report.pdf).pages)


def test_the_html_loads_nothing(html):
    parser = Resources()
    parser.feed(html)
    assert len(parser.loaded) >= 11
    assert all(value.startswith(("data:", "#")) for value in parser.loaded)
    assert "script" not in parser.tags
    styles = " ".join(re.findall(r"<style.*?</style>", html, re.S))
    assert "@import" not in styles and not re.search(r"url\(\s*['\"]?(?!data:|#)", styles)


def test_the_html_is_a_page_with_one_title_and_a_way_back(html):
    parser = Resources()
    parser.feed(html)
    assert parser.tags["h1"] == parser.tags["main"] == 1 and parser.tags["h2"] > 5
    assert (
        html.count('<div class="scroll" tabindex="0"') == parser.tags["table"] == html.count("</table></div>")
    )
    assert html.index('href="#content"') < html.index('href="../index.html"') < html.index('id="TOC"')


def test_both_carry_the_digest_of_their_configuration(html, report, digest):
    assert f'<meta name="configuration" content="{digest}">' in html
    assert PdfReader(report.pdf).metadata["/Keywords"] == f"configuration {digest}"


def test_its_figures_have_anchors_and_enlarge(html, report):
    names = re.findall(r'<figure id="(\w+)">\s*<a href="\.\./figures/(\w+)\.png"><img [^>]*></a>', html)
    assert sorted(names) == sorted((name, name) for name in report.inputs.figures)


def test_its_pictures_are_the_figures_pixel_by_pixel(html, report):
    pictures = re.findall(r'<figure id="(\w+)">.*?<img [^>]*src="data:image/webp;base64,([^"]+)"', html, re.S)
    assert len(pictures) == len(report.inputs.figures)
    for name, content in pictures:
        with (
            Image.open(BytesIO(b64decode(content))) as shown,
            Image.open(f"{report.inputs.figures_folder}/{name}.png") as drawn,
        ):
            assert shown.convert("RGB").tobytes() == drawn.convert("RGB").tobytes()


def test_its_equations_are_mathml(html):
    assert html.count("<math") > 150
    text = re.sub(r"<annotation.*?</annotation>", "", html, flags=re.S)
    assert not re.search(r"\\(?:frac|sqrt|tau|gamma|int)\b|\$\$", text)


def test_the_pdf_has_pages_on_a4_and_figures(report):
    pages = PdfReader(report.pdf).pages
    assert len(pages) >= 12
    assert {tuple(sorted(round(float(x)) for x in page.mediabox[2:])) for page in pages} == {(595, 842)}


def test_the_figures_of_the_pdf_have_their_alternative_texts(report, project):
    reader = PdfReader(report.pdf)
    objects = (reader.get_object(number) for number in range(1, int(reader.trailer["/Size"])))
    said = {entry["/Alt"] for entry in objects if isinstance(entry, dict) and "/Alt" in entry}
    captions = read_captions(project / "manuscript/captions.yaml")
    assert {captions[name].alt.strip() for name in report.inputs.figures} <= {text.strip() for text in said}


def test_the_report_has_the_typeface_of_its_figures(report):
    first = PdfReader(report.pdf).pages[0]["/Resources"]["/Font"]
    assert any(FAMILY in font.get_object()["/BaseFont"] for font in first.values())


@pytest.mark.slow
def test_equal_inputs_give_equal_bytes(report, build):
    again = build(report.inputs)
    assert again.pdf.read_bytes() == report.pdf.read_bytes()
    assert again.html.read_bytes() == report.html.read_bytes()


def test_both_have_the_numbers_of_the_ledger(report, html, pdf_text):
    claim = report.claims["front_speed"]
    for text in (html, pdf_text):
        flat = re.sub(r"\s+", " ", text)
        assert with_uncertainty(claim["measured"], claim["uncertainty"]) in flat
        assert measured_text(SimpleNamespace(**report.claims["grows_above_zero"])) in flat
        for id in report.claims:
            assert id in flat or id.replace("_", "_ ") in flat
    assert "{{" not in html.replace("{{ ", "{{") or "{{" not in re.sub(
        r"<(pre|code).*?</\1>", "", html, flags=re.S
    )
    assert yaml.safe_load(report.verdicts.read_text()) == {
        id: claim["verdict"] for id, claim in report.claims.items()
    }


def test_an_altered_run_changes_the_numbers_and_says_so(report, make_inputs, shipped):
    config = copy.deepcopy(shipped)
    config["simulations"]["space_time_displacement"]["left"] = [0.4]
    config["simulations"]["steady_displacement"]["left"] = [0.3]
    altered = make_inputs(config, scale=1.05)
    source = f"{altered.manuscript}/replication.md"
    before, after = execute(source, report.inputs), execute(source, altered)
    assert "Altered configuration" not in before
    top = after[: after.index("# Abstract")]
    assert "`simulations.space_time_displacement.left`: `[0.4]` (shipped: `[0.25]`)" in top
    assert "`simulations.steady_displacement.left`" in top
    assert "Verdicts that differ" in top
    for text, inputs in ((before, report.inputs), (after, altered)):
        tau = inputs.config["simulations"]["space_time_displacement"]["left"][0]
        assert rf"$\tau_0$ = {tau}" in text
        claim = next(claim for claim in inputs.claims if claim["id"] == "front_speed")
        assert with_uncertainty(claim["measured"], claim["uncertainty"]) in text
    assert with_uncertainty(1.05 * 1.00137, 0.00021) not in before


def test_a_claim_that_was_not_measured_is_said_to_be_so(make_inputs):
    inputs = make_inputs()
    for claim in inputs.claims:
        claim["measured"] = claim["uncertainty"] = None
        claim["verdict"] = "not testable"
    with open(inputs.claims_file, "w", encoding="utf-8") as file:
        json.dump(inputs.claims, file)
    text = execute(f"{inputs.manuscript}/replication.md", inputs)
    assert "not measured" in text and not re.search(r"\bnan\b", re.sub(r"`[^`]*`", "", text), re.I)


def test_a_scene_outside_the_theory_leaves_the_report_standing(make_inputs, shipped):
    config = copy.deepcopy(shipped)
    config["simulations"]["space_time_displacement"]["left"] = [-0.3]
    config["simulations"]["space_time_stress"]["left"] = [0.3]
    inputs = make_inputs(config)
    text = execute(f"{inputs.manuscript}/replication.md", inputs)
    assert "$T_\\mathrm{trans}$ = not measured" in text and r"$\tau_0$ = −0.3" in text


def test_a_failing_expression_is_one_line_that_names_it(make_inputs, tmp_path):
    (tmp_path / "small.md").write_text(
        "# Speed\n\nFirst.\n\nIt is {{ claim('no_such').measured }}.\n", encoding="utf-8"
    )
    with pytest.raises(ValueError, match=r"small\.md: .*no_such") as caught:
        execute(tmp_path / "small.md", make_inputs())
    assert "\n" not in str(caught.value)


def test_a_failing_cell_is_one_line_that_names_it(make_inputs, tmp_path):
    (tmp_path / "small.md").write_text("```python\nwidth = 1 / 0\n```\n", encoding="utf-8")
    with pytest.raises(
        ValueError, match=r"small\.md: ZeroDivisionError: .*\(cell 'width = 1 / 0'\)"
    ) as caught:
        execute(tmp_path / "small.md", make_inputs())
    assert "\n" not in str(caught.value)


def test_a_notebook_opened_by_hand_has_the_same_names(make_inputs, tmp_path, monkeypatch):
    from slippulse.report import notebook

    inputs, by_hand, here = make_inputs(), {}, {}
    (tmp_path / "config").mkdir()
    (tmp_path / "config/config.yaml").write_text("{}", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(notebook.Inputs, "of_project", lambda project: inputs)
    notebook.define_by_hand(by_hand)
    notebook.define(here, inputs, print)
    assert set(by_hand) == set(here)
