"""The index and the other pages: structure, keyboard, alternative texts, and no outside links."""

import json
import re
from base64 import b64encode
from hashlib import sha256
from html.parser import HTMLParser
from itertools import pairwise, product

import pytest
import yaml
from PIL import Image
from report.conftest import CLAIM, FRONT

from slippulse_paper.claims.kinds import Qualitative
from slippulse_paper.claims.paper_claims import fields_of_claim
from slippulse_paper.records.provenance import provenance
from slippulse_paper.report import html
from slippulse_paper.report.claims_page import SIGNS, claims_page
from slippulse_paper.report.index_page import index_page
from slippulse_paper.report.texts import ERRATUM

VOID = {"meta", "link", "img", "br", "hr", "input"}
FAILED = CLAIM | {"id": "width", "verdict": "not reproduced", "why": "It is *off*."}
FAILED |= {"measured": 1.5, "deviation": 0.2, "figure": ""}
ALWAYS = FRONT | {"kind": "qualitative", "tolerance": 0.0, "follows_from": ["speed"]}
OPEN = fields_of_claim("always", Qualitative(decided=[True] * 3 + [None] * 2), ALWAYS, "III A")
FINDING = {"id": "ours", "numbers": {"gap": 0.5}, "text": "a gap of $x$", "source": "other"}
NEVER = CLAIM | {"id": "length", "verdict": "not testable", "note": "", "flips_at": []}
NEVER |= dict.fromkeys(["predicted", "measured", "uncertainty", "runs", "deviation"])
CLAIMS = [CLAIM, FAILED, NEVER, OPEN]
TABLES = ["measurements/runs.csv", "predictions/runs.csv", "studies/other.csv"]
TABLES += ["uncertainties/runs.csv"]
NAMES = {"fig01_one": "One <figure>", "fig02_two": "Another & another"}


class Outline(HTMLParser):
    """The tags of a page in order, with their attributes. Fails if tags are not closed in order."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict]] = []
        self.open: list[str] = []
        self.feed(text)
        assert self.open == []
        self.ids = [attributes["id"] for _, attributes in self.tags if "id" in attributes]

    def handle_starttag(self, tag, attributes):
        assert len(attributes) == len(dict(attributes))
        self.tags.append((tag, dict(attributes)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def all(self, tag: str) -> list[dict]:
        return [attributes for name, attributes in self.tags if name == tag]


@pytest.fixture(scope="module")
def results(project, shipped, tmp_path_factory):
    """Return the folder of a small run with another preset, next to the texts of its page."""
    results = tmp_path_factory.mktemp("page") / "results"
    figures = [f"figures/{name}{ending}" for name, ending in product(NAMES, (".pdf", ".csv"))]
    for path in [*TABLES, "scenes/made.html", *figures]:
        (results / path).parent.mkdir(parents=True, exist_ok=True)
        (results / path).touch()
    for name in NAMES:
        Image.new("1", (900, 600)).save(results / f"figures/{name}.png")
    (results / "claims.html").write_text(claims_page(CLAIMS, (), (), TABLES), encoding="utf-8")
    facts = provenance(project, shipped | {"preset": "draft"}, shipped, results)
    facts["times"]["seconds_of_jobs"] = {"one": 1.5}
    caption = {"alt": "A line <up>", "caption": "(a) $x$."}
    caption["finding"] = "Found in {{ claim('speed').runs }} runs."
    met = {"topic": "Yes", "named": "fronts run", "claims": {"speed": "speeds"}, "text": "Gap."}
    summary = {"question": "Do they run?", "symbols": "$H$ is a height.", "verdict": [met]}
    summary["accuracy"] = "Of {{ claim('speed').runs }} runs, {{ misprints | length }} misprint."
    number = "gap {{ found('ours').gap }}"
    summary["statements"] = [
        {"statement": "Fronts run.", "claims": ["speed"], "number": number},
        {"statement": "They are wide.", "claims": ["length", "width"], "number": "none"},
    ]
    summary["words"] = [{"term": "Height $H$", "meaning": "{{ claim('speed').runs }} metres."}]
    captions = {name: caption | {"title": title} for name, title in NAMES.items()}
    for name, content in {"claims": CLAIMS, "findings": [FINDING], "provenance": facts}.items():
        (results / f"{name}.json").write_text(json.dumps(content), encoding="utf-8")
    erratum = dict.fromkeys(ERRATUM, "text")
    for name, content in {"captions": captions, "summary": summary, "errata": [erratum]}.items():
        (results.parent / f"{name}.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")
    return results


@pytest.fixture(scope="module")
def page(results) -> str:
    texts = {name: results.parent / f"{name}.yaml" for name in ("captions", "summary", "errata")}
    galleries = {"Figures of the paper": ["fig01_one"], "Studies": ["fig02_two"]}
    scenes = {"made": "A scene <that> is there", "not_made": "A scene that is not"}
    return index_page(results, texts, galleries, scenes)


def check_accessible(text: str) -> Outline:
    outline = Outline(text)
    assert text.startswith("<!DOCTYPE html>")
    assert outline.all("html") == [{"lang": "en"}]
    view = {"name": "viewport", "content": "width=device-width, initial-scale=1"}
    assert view in outline.all("meta")
    for tag in ("title", "h1", "main", "header"):
        assert len(outline.all(tag)) == 1
    levels = [int(tag[1]) for tag, _ in outline.tags if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1 and all(after - before <= 1 for before, after in pairwise(levels))
    assert len(outline.ids) == len(set(outline.ids))
    assert all(image["alt"].strip() for image in outline.all("img"))
    assert outline.all("a")[0] == {"class": "skip", "href": "#content"}
    labels = [attributes.get("aria-label") for attributes in outline.all("nav")]
    assert len(labels) == len(set(labels)) and all(labels)
    # The keyboard reaches every region that scrolls sideways, and each has a name.
    regions = [tag for tag in outline.all("div") if tag.get("class") == "scroll"]
    assert all((tag["tabindex"], tag["role"]) == ("0", "region") for tag in regions)
    assert all(tag["aria-label"] for tag in regions)
    assert len(outline.all("caption")) == len(outline.all("table"))
    assert all(attributes["scope"] == "col" for attributes in outline.all("th"))
    assert {tag.get("tabindex", "0") for _, tag in outline.tags} <= {"0", "-1"}
    assert not outline.all("script") and "@import" not in text and "url(" not in text
    return outline


def test_pages_can_be_read_without_eyes_or_mouse(page):
    scenes = check_accessible(html.page("scenes.html", scenes={"one": "A <scene>", "two": "More"}))
    assert [image["src"] for image in scenes.all("img")] == ["one.png", "two.png"]
    outline = check_accessible(page)
    # Each figure is there once, with its size.
    pictures = [(image["src"], image["width"], image["height"]) for image in outline.all("img")]
    assert pictures == [(f"figures/{name}.png", "360", "240") for name in NAMES]
    # The table of statements comes before all figures.
    tags = [tag for tag, _ in outline.tags]
    assert tags.index("table") < tags.index("img")
    assert {image["alt"] for image in outline.all("img")} == {"A line <up>"}


def test_links_lead_somewhere_and_only_the_paper_is_outside(page, results):
    outline = Outline(page)
    targets = [a["href"] for a in outline.all("a")] + [image["src"] for image in outline.all("img")]
    assert len(targets) >= 20
    outside = [target for target in targets if re.match(r"[a-z]+:|/", target)]
    assert outside == ["https://doi.org/10.1103/PhysRevE.103.052802"]
    claims = Outline((results / "claims.html").read_text(encoding="utf-8"))
    for target in set(targets) - set(outside):
        path, _, anchor = target.partition("#")
        assert (results / path).exists(), target
        assert not anchor or anchor in (claims if path == "claims.html" else outline).ids, target


def test_it_says_what_was_found_and_from_what(page):
    assert "3 counted claims: 1 reproduced, 1 not reproduced, 1 not testable." in page
    assert "Do they run? <strong>Yes</strong>: fronts run.</p>" in page
    assert "A scene &lt;that&gt; is there" in page and "One &lt;figure&gt;" in page
    assert "Found in 4 runs." in page and "Of 4 runs, 1 misprint." in page
    assert "1 value differs" in page and "<td>preset</td><td>paper</td><td>draft</td>" in page
    order = ("value differs", "the paper states", "4 metres.", "Figures of the paper</h2>")
    assert sorted(order, key=page.index) == [*order]
    assert "results/scenes/not_made.html" in page


def test_a_row_has_a_statement_its_worst_verdict_a_number_and_a_figure(page):
    rows = re.findall(r"<tr role=.row.>(.*?)</tr>", page, re.S)[:2]
    texts = [re.sub(r"<span.*?</span>|<.*?>|\s+", " ", row, flags=re.S).split() for row in rows]
    assert texts[0] == f"Fronts run. {SIGNS['reproduced']} reproduced gap 0.500 figure 1".split()
    assert texts[1] == f"They are wide. {SIGNS['not reproduced']} not reproduced none".split()
    assert 'href="claims.html#speed"' in rows[0] and 'href="#fig01_one"' in rows[0]
    assert 'href="claims.html#width"' in rows[1]


def test_the_ledger_has_a_page_with_failures_first():
    text = claims_page(CLAIMS, (), [FINDING], TABLES)
    outline = check_accessible(text)
    ids = [row["id"] for row in outline.all("tr") if "id" in row]
    assert ids == ["width", "always", "length", "speed"]
    assert outline.all("a")[1] == {"href": "index.html"}
    assert "20 %, tolerance 0.1 %" in text and 'aria-label="200 × tolerance"' in text
    assert '<p class="why">It is <em>off</em>.</p>' in text and "3 of 5, 2 undecided" in text
    assert '<li id="ours">a gap of <math' in text and "follows from <code>speed</code>" in text
    assert "1 not testable. 1 further claims are not counted" in text
    assert "1.25010(10)" in text and "not measured" in text
    assert "\\gamma" not in re.sub("<annotation.*?</annotation>", "", text)
    assert '<a href="figures/fig01_one.png">figure 1, one</a>' in text
    assert "fronts &lt;outrun&gt; the waves &amp; keep <math" in text
    # A number links to its tables and their command, of the simulations that its source names.
    links = [a["href"] for a in outline.all("a") if a["href"].endswith(".csv")]
    assert links == [TABLES[0], TABLES[1], TABLES[3]] * len(CLAIMS) + [TABLES[2]]
    made = " ".join(f"results/{path}" for path in links[:3])
    assert f"make replicate TARGET=&#34;{made}&#34;" in text


def test_the_policy_of_a_page_allows_its_own_script_and_no_other():
    pages = {"scenes.html": {"scenes": {}}, "explorer.html": {"data": "{}", "largest_ratio": 2.0}}
    for template, data in pages.items():
        text = html.page(template, **data)
        policies = Outline(text).all("meta")
        (policy,) = [meta["content"] for meta in policies if "http-equiv" in meta]
        rules = dict(rule.strip().split(" ", 1) for rule in policy.split(";"))
        assert rules["default-src"] == rules["base-uri"] == rules["form-action"] == "'none'"
        scripts = re.findall(r"<script>(.*?)</script>", text, re.S)
        digests = [b64encode(sha256(script.encode()).digest()).decode() for script in scripts]
        sources = [f"'sha256-{digest}'" for digest in digests] or ["'none'"]
        assert rules["script-src"].split() == sources
        assert len(scripts) == (template == "explorer.html")
