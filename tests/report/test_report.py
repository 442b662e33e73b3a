"""The finished report is complete and self-contained, and has the numbers of its run."""

import json
import re
from base64 import b64decode
from dataclasses import replace
from io import BytesIO

import pandas as pd
import pytest
import yaml
from PIL import Image
from report.conftest import DIGEST

from slippulse.plotting.style import FONT_FAMILY
from slippulse_paper.claims.ledger import with_texts
from slippulse_paper.configuration.read import read_config
from slippulse_paper.report.manuscript import DOCUMENTS, execute, names_for
from slippulse_paper.report.report_tables import STUDIED_QUANTITIES, grid_studies
from slippulse_paper.report.texts import read_captions
from slippulse_paper.steps import write_report
from slippulse_paper.steps.inputs import LoadedInputs
from slippulse_paper.text.numerals import with_uncertainty

# Pages of the report; the supplement may be longer.
MOST_PAGES = 10


@pytest.mark.parametrize("document", range(len(DOCUMENTS)))
def test_the_html_is_one_page_that_loads_nothing_and_says_what_it_was_made_by(document, report):
    html, pdf = report.pages[document], report.pdfs[document]
    loading = r'<(?!a\b)[^>]*\s(?:src|srcset|data|poster|background|action|href)="([^"]*)"'
    assert all(value.startswith(("data:", "#")) for value in re.findall(loading, html))
    tags = ("script", "h1", "h2", "main", "table")
    count = {tag: len(re.findall(rf"<{tag}\b", html)) for tag in tags}
    assert count["script"] == 0
    styles = " ".join(re.findall(r"<style.*?</style>", html, re.S))
    assert "@import" not in styles and not re.search(r"url\(\s*['\"]?(?!data:|#)", styles)
    assert count["h1"] == count["main"] == 1 and count["h2"] > 5
    scrolled = [html.count(part) for part in ('<div class="scroll" tabindex="0"', "</table></div>")]
    assert scrolled == [count["table"]] * 2
    order = ('href="#content"', 'href="../index.html"', 'id="TOC"')
    assert sorted(order, key=html.index) == [*order]
    assert html.count("<math") > 50
    text = re.sub(r"<annotation.*?</annotation>", "", html, flags=re.S)
    assert not re.search(r"\\(?:frac|sqrt|tau|gamma|int)\b|\$\$", text)
    citation = report.inputs.citation
    version = f"Version {citation['version']}, {citation['date-released']}"
    assert f'<meta name="configuration" content="{DIGEST}">' in html
    assert pdf.metadata["/Keywords"] == f"configuration {DIGEST}"
    assert version in " ".join(html.split()) and version in pdf.pages[0].extract_text()


def test_its_pictures_are_the_figures_pixel_by_pixel_and_enlarge(report):
    link = r'<a href="\.\./figures/(\w+)\.png">'
    image = r'<img src="data:image/png;base64,([^"]+)"[^>]*>'
    pictures = re.findall(rf'<figure id="(\w+)">\s*{link}{image}</a>', "".join(report.pages))
    assert sorted(name for name, _, _ in pictures) == sorted(report.inputs.figures)
    for name, link, content in pictures:
        path = report.inputs.figures_folder / f"{name}.png"
        with Image.open(BytesIO(b64decode(content))) as shown, Image.open(path) as drawn:
            assert shown.convert("RGB").tobytes() == drawn.convert("RGB").tobytes()
        assert link == name


def test_the_pdf_is_a4_in_the_typeface_of_its_figures_which_have_alternative_texts(report):
    pdf = report.pdfs[0]
    assert len(pdf.pages) <= MOST_PAGES
    for page in pdf.pages:
        assert sorted(round(float(x)) for x in page.mediabox[2:]) == [595, 842]
    fonts = pdf.pages[0]["/Resources"]["/Font"].values()
    assert any(FONT_FAMILY in font.get_object()["/BaseFont"] for font in fonts)
    said = set()
    for one in report.pdfs:
        objects = (one.get_object(number) for number in range(1, int(one.trailer["/Size"])))
        entries = [entry for entry in objects if isinstance(entry, dict) and "/Alt" in entry]
        said |= {entry["/Alt"].strip() for entry in entries}
    captions = read_captions(report.inputs.manuscript / "captions.yaml")
    assert {captions[name].alt for name in report.inputs.figures} <= said


@pytest.mark.slow
def test_equal_inputs_give_equal_bytes(report, build):
    again = build(report.inputs)
    for kind in ("pdf", "html"):
        for one, other in zip(getattr(again, kind), getattr(report, kind), strict=True):
            assert one.read_bytes() == other.read_bytes()


def test_both_have_the_numbers_of_the_ledger(report):
    claim = report.claims["front_speed"]
    for text in (report.pages[1], " ".join(page.extract_text() for page in report.pdfs[1].pages)):
        flat = re.sub(r"\s+", " ", text)
        assert with_uncertainty(claim["measured"], claim["uncertainty"]) in flat
        assert with_texts(report.claims["grows_above_zero"]).measured_text() in flat
        for id in report.claims:
            assert id in flat or id.replace("_", "_ ") in flat
    for html in report.pages:
        assert "{{" not in re.sub(r"<(pre|code).*?</\1>", "", html, flags=re.S)
    # A number of the report leads to its claim.
    assert '<a href="../claims.html#front_speed">' in report.pages[0]
    verdicts = {id: claim["verdict"] for id, claim in report.claims.items()}
    assert yaml.safe_load(report.verdicts.read_text()) == verdicts


def test_an_altered_run_changes_the_numbers_and_says_so(report, make_inputs, config, manuscript):
    config["simulations"]["space_time_displacement"]["left"] = [0.4]
    config["simulations"]["steady_displacement"]["left"] = [0.3]
    altered = make_inputs(config, scale=1.05)
    documents = [manuscript / f"{name}.md" for name in DOCUMENTS]
    both = (report.inputs, altered)
    before = "".join(execute(document, report.inputs) for document in documents)
    after = "".join(execute(document, altered) for document in documents)
    assert "Altered configuration" not in before
    top = after[: after.index("# The answer")]
    assert "`simulations.space_time_displacement.left`: `[0.4]` (shipped: `[0.25]`)" in top
    assert "`simulations.steady_displacement.left`" in top and "Verdicts that differ" in top
    for text, inputs in zip((before, after), both, strict=True):
        tau = inputs.config["simulations"]["space_time_displacement"]["left"][0]
        claim = next(claim for claim in inputs.claims if claim["id"] == "front_speed")
        assert rf"$\tau_0$ = {tau}" in text
        assert with_uncertainty(claim["measured"], claim["uncertainty"]) in text
    assert with_uncertainty(1.05 * 1.00137, 0.00021) not in before


def test_what_was_not_measured_or_has_no_theory_is_said_to_be_so(report, manuscript):
    nothing = {"measured": None, "uncertainty": None, "verdict": "not testable"}
    tables = dict(report.inputs.tables)
    for name in ("space_time_displacement", "space_time_stress"):
        tables[name] = tables[name] * float("nan")
    tables["derivations"] = tables["derivations"].assign(value=float("nan"))
    claims = [claim | nothing for claim in report.inputs.claims]
    inputs = replace(report.inputs, claims=claims, tables=tables)
    text = execute(manuscript / "supplement.md", inputs)
    assert "$T_\\mathrm{trans}$ = not measured" in text
    assert not re.search(r"\bnan\b", re.sub(r"`[^`]*`", "", text), re.I)


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("# Speed\n\nFirst.\n\nIt is {{ claim('no_such').measured }}.\n", ".*no_such"),
        ("```python\nwidth = 1 / 0\n```\n", r"ZeroDivisionError: .*\(cell 'width = 1 / 0'\)"),
    ],
)
def test_what_fails_is_one_line_that_names_it(report, tmp_path, source, reason):
    (tmp_path / "small.md").write_text(source, encoding="utf-8")
    with pytest.raises(ValueError, match=rf"small\.md: {reason}") as caught:
        execute(tmp_path / "small.md", report.inputs)
    assert "\n" not in str(caught.value)


def test_a_notebook_opened_by_hand_has_the_same_names(report, project, tmp_path, monkeypatch):
    inputs, results = report.inputs, tmp_path / "results"
    for part in ("config", "manuscript", "CITATION.cff"):
        (tmp_path / part).symlink_to(project / part)
    results.mkdir()
    (results / "figures").symlink_to(inputs.figures_folder)
    contents = {"claims": inputs.claims, "findings": inputs.findings}
    contents["provenance"] = {"config": inputs.config}
    for name, content in contents.items():
        (results / f"{name}.json").write_text(json.dumps(content), encoding="utf-8")
    monkeypatch.chdir(results)
    loaded = LoadedInputs({}, inputs.tables)
    monkeypatch.setattr(write_report, "load_inputs", lambda files: loaded)
    names = names_for(inputs, print, DOCUMENTS[0])
    assert set(write_report.notebook_names(DOCUMENTS[0], print)) == set(names)


def test_a_hostile_text_of_an_overlay_is_only_shown(make_inputs, build, shipped):
    text = "[x](javascript:alert(4)) [y]{onmouseover=alert(1)} <b id=z> `w`{=html} | @v"
    text += " ![u](secret.png)"
    overlay = {"published": {"intercept": {"statement": text}}}
    config = read_config(shipped, [overlay], every_run=False).given()
    built = build(make_inputs(config))
    for html in built.pages:
        opened = "".join(re.findall(r"<[a-z][^>]*>", html))
        assert not re.search(r"javascript:|onmouseover|id=.?z\b|secret", opened)
        assert html.count('http-equiv="Content-Security-Policy"') == 1
    assert any("[x](javascript:alert(4))" in " ".join(html.split()) for html in built.pages)
    for page in [page for pdf in built.pdfs for page in pdf.pages]:
        links = [note.get_object().get("/A", {}) for note in page.get("/Annots", [])]
        assert not any("javascript" in str(link).lower() for link in links)


@pytest.mark.parametrize("known", [0, 1, 2])
def test_the_table_of_grid_studies_counts_runs_with_a_known_uncertainty(known):
    rows = [
        {
            "quantity": quantity,
            "value": 1.0,
            "uncertainty": 0.01 if run < known else float("nan"),
            "observed_order": 1.0,
        }
        for _, quantity, _ in STUDIED_QUANTITIES
        for run in range(2)
    ]
    studies = {f"uncertainties/{name}": pd.DataFrame(rows) for name, _, _ in STUDIED_QUANTITIES}
    cells = [cell.strip() for cell in str(grid_studies(studies)).splitlines()[-1].split("|")]
    assert str(known) in cells
