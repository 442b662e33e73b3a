"""The page of results: structure, keyboard, alternative texts, links, nothing from outside. No browser needed."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from itertools import pairwise

import pytest

from slippulse.data.provenance import provenance
from slippulse.figures.style import new_figure, save_figure
from slippulse.pages.index import captions_from, claims_page, index_page, scenes_page

VOID = {"meta", "link", "img", "br", "hr", "input"}
CLAIM = {
    "id": "speed", "figure_or_section": "III A", "statement": "fronts <outrun> the waves & keep going",
    "predicted": 1.25, "measured": 1.2501, "uncertainty": 1e-4, "tolerance": 1e-3, "verdict": "reproduced",
    "note": "", "source": "",
}  # fmt: skip
FIGURES = {"fig01_one": "One figure <here>. With more to say.", "fig02_two": "Another & another."}


class Outline(HTMLParser):
    """Tags in order, with their attributes; refuses tags that do not close in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict]] = []
        self.open: list[str] = []
        self.feed(text)
        assert self.open == []

    def handle_starttag(self, tag, attributes):
        assert len(attributes) == len(dict(attributes))
        self.tags.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def all(self, tag: str) -> list[dict]:
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture
def page(project, config, tmp_path) -> str:
    for name in FIGURES:
        figure = new_figure(3.0, 2.0)
        figure.subplots().plot([0.0, 1.0])
        (tmp_path / "figures").mkdir(exist_ok=True)
        save_figure(figure, tmp_path / f"figures/{name}.png", tmp_path / f"figures/{name}.pdf")
        (tmp_path / f"figures/{name}.csv").write_text("x\n0\n")
    (tmp_path / "claims.json").write_text("[]")
    (tmp_path / "benchmarks").mkdir()
    (tmp_path / "benchmarks/one.tsv").write_text("s\th:m:s\n1.5\t0:00:01\n")
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes/made.html").write_text("<p>")
    changed = config | {"preset": "draft"}
    facts = provenance(project, changed, config, tmp_path / "benchmarks")
    claims = [
        CLAIM,
        CLAIM | {"verdict": "not testable", "predicted": None, "measured": None, "uncertainty": None},
    ]
    scenes = {"made": "A scene <that> is there", "not_made": "A scene that is not"}
    return index_page(
        tmp_path,
        {"fig01_one": FIGURES["fig01_one"]},
        {"fig02_two": FIGURES["fig02_two"]},
        claims,
        facts,
        scenes,
    )


def test_it_is_one_page_in_order(page):
    outline = Outline(page)
    assert page.startswith("<!DOCTYPE html>")
    assert outline.all("html") == [{"lang": "en"}]
    assert {"name": "viewport", "content": "width=device-width, initial-scale=1"} in outline.all("meta")
    for tag in ("title", "h1", "main", "header"):
        assert len(outline.all(tag)) == 1
    levels = [int(tag[1]) for tag, _ in outline.tags if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1 and all(after - before <= 1 for before, after in pairwise(levels))
    identifiers = [attributes["id"] for _, attributes in outline.tags if "id" in attributes]
    assert len(identifiers) == len(set(identifiers))


def test_it_can_be_read_without_eyes_or_mouse(page):
    outline = Outline(page)
    images = outline.all("img")
    assert len(images) == 2 and all(image["alt"].strip() for image in images)
    assert images[0]["alt"] == "One figure <here>"
    assert images[0]["width"] == "900"
    assert outline.all("a")[0] == {"class": "skip", "href": "#content"}
    labels = [attributes.get("aria-label") for attributes in outline.all("nav")]
    assert len(labels) == len(set(labels)) and all(labels)
    # What scrolls sideways can be reached by keyboard and has a name.
    for region in (attributes for attributes in outline.all("div") if attributes.get("class") == "scroll"):
        assert region["tabindex"] == "0" and region["role"] == "region" and region["aria-label"]
    assert len(outline.all("caption")) == len(outline.all("table")) >= 3
    assert all(attributes["scope"] == "col" for attributes in outline.all("th"))
    assert not any(attributes.get("tabindex", "0") not in ("0", "-1") for _, attributes in outline.tags)


def test_links_are_relative_and_lead_somewhere(page, tmp_path):
    outline = Outline(page)
    identifiers = {attributes["id"] for _, attributes in outline.tags if "id" in attributes}
    targets = [a["href"] for a in outline.all("a")] + [image["src"] for image in outline.all("img")]
    assert len(targets) > 10
    for target in targets:
        if target.startswith("#"):
            assert target[1:] in identifiers
        else:
            assert not re.match(r"[a-z]+:|/", target)
            assert (tmp_path / target).exists(), target
    assert not outline.all("script") and "@import" not in page and "url(" not in page


def test_it_says_what_was_found_and_from_what(page):
    assert "2 claims: 1 reproduced, 1 not testable" in page
    assert "fronts &lt;outrun&gt; the waves &amp; keep going" in page
    assert "A scene &lt;that&gt; is there" in page
    assert "1 values differ" in page and "<td>preset</td><td>paper</td><td>draft</td>" in page
    assert "results/scenes/not_made.html" in page


def test_the_ledger_is_a_table_on_a_page_of_its_own():
    text = claims_page([CLAIM, CLAIM | {"statement": "a < b", "uncertainty": None}])
    assert "<details" not in text
    assert text.count("<tr") == 3 and "a &lt; b" in text
    assert f"2 claims: 2 {CLAIM['verdict']}." in text


def test_the_list_of_scenes_is_a_page_too(tmp_path):
    outline = Outline(scenes_page({"one": "A <scene>", "two": "Another"}))
    assert [image["alt"] for image in outline.all("img")] == ["A <scene>", "Another"]


def test_captions_are_plain_text_with_their_settings(project, config):
    settings = {"measure": config["measure"], "paper_damping_ratio": 0.1} | {
        key: value for figure in config["figures"].values() for key, value in figure.items()
    }
    paths = [
        *(project / "workflow/report").glob("fig*.rst"),
        *(project / "workflow/report").glob("study_*.rst"),
    ]
    captions = captions_from({path.stem: {"caption": path, "settings": settings} for path in paths})
    assert len(captions) >= 17
    for name, caption in captions.items():
        assert len(caption) > 40 and "\n" not in caption and "{" not in caption, name
        # An alternative text is a sentence, not a page.
        assert len(caption.split(". ")[0]) < 400, name
    assert f"covered {config['measure']['share']} of" in captions["fig05_scaling"]


def test_a_caption_that_quotes_anything_else_is_refused(tmp_path):
    (tmp_path / "a.rst").write_text("It is {{ snakemake.config }}.")
    with pytest.raises(ValueError, match="quotes what is no setting"):
        captions_from({"a": {"caption": tmp_path / "a.rst", "settings": {}}})
