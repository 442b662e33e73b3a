"""The documentation site in a browser: accessibility, links, and a search without a network.

`make test-site` builds the site and names its folder.
"""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from browser.conftest import SCHEMES
from playwright.sync_api import Page

pytestmark = pytest.mark.slow

SITE = os.environ.get("SITE", "")
PAGES = ("index", "docs/tutorial", "docs/equations", "docs/compare", "docs/howto", "docs/reference")
PAGES += ("docs/gallery/index", "docs/gallery/barrier", "docs/gallery/laboratory_block")
PAGES += ("reference/slippulse", "reference/slippulse/slippulse.Scene", "config/README", "search")
WIDTHS = (400, 1440)


@pytest.fixture(scope="module")
def site(project) -> Path:
    if not SITE:
        pytest.skip("no folder of the site named: make test-site")
    return project / SITE


@pytest.fixture(scope="module")
def opened(browser):
    """A function that opens a page, which must load nothing from outside and raise no error."""

    @contextmanager
    def open_page(path: Path, width: int = 1440, scheme: str = "light") -> Iterator[Page]:
        page = browser.new_page(viewport={"width": width, "height": 900}, color_scheme=scheme)
        errors, fetched = [], []
        page.on("pageerror", lambda error: errors.append(str(error)))
        page.on("request", lambda request: fetched.append(request.url))
        page.goto(path.absolute().as_uri())
        yield page
        page.close()
        assert errors == []
        assert [url for url in fetched if not url.startswith(("file:", "data:"))] == []

    return open_page


def test_the_site_leaves_no_other_files_in_the_results(site):
    assert (site / "index.html").exists() and not (site.parent / "jupyter_execute").exists()


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("name", PAGES)
def test_everybody_can_read_it(name, width, scheme, site, opened, violations):
    with opened(site / f"{name}.html", width, scheme) as page:
        page.wait_for_timeout(200)
        assert page.locator("h1").count() == page.locator("main").count() == 1
        assert violations(page) == []


def test_every_link_leads_somewhere(site, opened):
    names = sorted(path for path in site.rglob("*.html") if "_static" not in path.parts)
    assert len(names) > 60
    tags = "[...document.querySelectorAll('a[href], img[src], link[href], script[src]')]"
    anchors, links = {}, {}
    for name in names:
        with opened(name) as page:
            found = page.evaluate(f"{tags}.map((tag) => tag.href || tag.src)")
            ids = page.evaluate("[...document.querySelectorAll('[id]')].map((tag) => tag.id)")
        anchors[name.absolute()] = set(ids)
        links |= {link: name for link in found if link.startswith("file:")}
    for link, name in links.items():
        parts = urlsplit(link)
        path = Path(unquote(parts.path))
        assert path.exists(), (name, link)
        fragment = unquote(parts.fragment)
        assert not fragment or path not in anchors or fragment in anchors[path], (name, link)


@pytest.mark.parametrize(
    ("word", "title"),
    [("barrier", "Which barriers does a pulse pass"), ("Slurm", "A million runs")],
)
def test_the_search_works_without_a_network(word, title, site, opened):
    with opened(site / "search.html") as page:
        page.goto(f"{(site / 'search.html').absolute().as_uri()}?q={word}")
        page.locator("#search-results li").first.wait_for(timeout=20_000)
        results = page.locator("#search-results").inner_text()
    assert title in results
