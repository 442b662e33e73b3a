"""The pages of a results folder in a browser: links, accessibility, narrow screens, dark colours.

`make test-pages` names the folder, which must be complete; without it only the explorer is tested.
"""

import math
import os
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from browser.conftest import SCHEMES, WIDTHS

pytestmark = pytest.mark.slow

RESULTS = os.environ.get("PAGES", "")
PAGES = ("index.html", "claims.html", "explorer.html", "scenes/barrier.html")
PAGES += ("manuscript/replication.html", "manuscript/supplement.html")
# Largest sizes of the explorer, and of the report with all its figures inside.
LARGEST = {"explorer.html": 300e3, "manuscript/replication.html": 3.5e6}


@pytest.fixture(scope="module")
def results(project) -> Path:
    if not RESULTS:
        pytest.skip("no results folder named: make test-pages")
    return project / RESULTS


def test_every_column_of_every_table_is_explained(results, project):
    rows = (project / "docs/columns.md").read_text(encoding="utf-8").splitlines()
    described = {row.split("`")[1] for row in rows if row.startswith("| `")}
    tables = sorted(results.rglob("*.csv"))
    assert len(tables) > 100
    for path in tables:
        columns = path.open(encoding="utf-8").readline().rstrip("\n").split(",")
        named = {column for column in columns if not column.startswith("trailing_edge_")}
        assert named <= described, path


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("name", PAGES)
def test_everybody_can_read_it(name, width, scheme, results, opened, violations):
    with opened(results / name, width, scheme) as page:
        assert page.locator("h1").count() == page.locator("main").count() == 1
        page.keyboard.press("Tab")
        assert page.evaluate("document.activeElement.getAttribute('href')") == "#content"
        assert name == "index.html" or page.locator("a[href$='index.html']").count() > 0
        assert violations(page) == []
    assert (results / name).stat().st_size < LARGEST.get(name, math.inf)


def test_every_link_resolves(results, opened):
    anchors, inside = {}, set()
    linked = "[...document.querySelectorAll('a[href], img[src], link[href]')]"
    for name in PAGES:
        with opened(results / name) as page:
            links = page.evaluate(f"{linked}.map((tag) => tag.href || tag.src)")
            names = page.evaluate("[...document.querySelectorAll('[id]')].map((tag) => tag.id)")
        anchors[(results / name).absolute()] = names
        assert all(link.startswith(("file:", "https://", "data:")) for link in links)
        inside |= {link for link in links if link.startswith("file:")}
    assert len(inside) > 100
    for link in inside:
        parts = urlsplit(link)
        path = Path(unquote(parts.path))
        assert path.exists(), link
        assert not parts.fragment or unquote(parts.fragment) in anchors[path], link


def test_print_unfolds_what_is_folded(results, opened):
    with opened(results / "claims.html") as page:
        page.emulate_media(media="print")
        assert page.locator("details:not([open]) .data").first.bounding_box()["height"] > 0
