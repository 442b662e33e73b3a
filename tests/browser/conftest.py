"""Start a real browser, if one is installed: chromium or a similar one."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pandas as pd
import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page, sync_playwright

from slippulse_paper.report.explorer_page import explorer_page
from slippulse_paper.studies import explorer_law

NAMES = ("chromium", "chromium-browser", "google-chrome")
WIDTHS, SCHEMES = (390, 1280), ("light", "dark")
# Rules of WCAG at the levels A and AA.
LEVELS = ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa"]
# A simulated run that the explorer can show.
RUN = {"boundary": "displacement", "left": 0.3, "right": 0.3, "width": 1.0, "peak": 1.0}
RUN |= {"gamma": 0.5, "beta": 1e-3, "damping_ratio": 0.1, "release": "total"}
RUN |= {"steps_and_bumps": '{"steps": [], "bumps": []}', "front_speed_right": 1.1}
RUN |= {"transition_time": 4.1, "transition_length": 10.1}
RUN |= {"pulse_slip": 1.11, "pulse_state": "steady"}


@pytest.fixture(scope="session")
def browser():
    """Start a browser; tests are skipped if none is installed."""
    installed = [path for path in map(shutil.which, NAMES) if path is not None]
    if not installed:
        pytest.skip(f"no browser: none of {', '.join(NAMES)} is installed")
    with sync_playwright() as playwright:
        # A container has no rights for a sandbox, and the pages are ours.
        browser = playwright.chromium.launch(executable_path=installed[0], args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def opened(browser):
    """Return a function that opens a page, and fails if it logs, fetches or raises anything."""

    @contextmanager
    def open_page(path: Path, width: int = 1280, scheme: str = "light") -> Iterator[Page]:
        page = browser.new_page(viewport={"width": width, "height": 844}, color_scheme=scheme)
        logged, fetched = [], []
        page.on("console", lambda message: logged.append(message.text))
        page.on("pageerror", lambda error: logged.append(str(error)))
        page.on("request", lambda request: fetched.append(request.url))
        page.goto(path.absolute().as_uri())
        try:
            yield page
            assert logged == []
            from_outside = [url for url in fetched if not url.startswith(("file:", "data:"))]
            assert from_outside == []
        finally:
            page.close()

    return open_page


@pytest.fixture(scope="session")
def violations():
    """Return a function that lists what is not accessible on a page or wider than the page."""
    axe = Axe()

    def find(page: Page) -> list[str]:
        root = "document.documentElement"
        wide = page.evaluate(f"{root}.scrollWidth - {root}.clientWidth")
        # Thousands of elements in the colour of their text would take most of the time.
        inline = "document.querySelectorAll('math[display=inline]')"
        page.evaluate(f"{inline}.forEach((formula) => formula.remove())")
        options = {"runOnly": {"type": "tag", "values": LEVELS}, "resultTypes": ["violations"]}
        problems = [f"wider than the page by {wide}"] if wide > 0 else []
        for violation in axe.run(page, options=options).response["violations"]:
            elements = [node["html"][:200] for node in violation["nodes"]]
            problems += [f"{violation['id']}: {element}" for element in elements]
        return problems

    return find


@pytest.fixture(scope="session")
def explorer(tmp_path_factory):
    """Return the path of an explorer with one simulated run."""
    path = tmp_path_factory.mktemp("explorer") / "explorer.html"
    page = explorer_page(explorer_law.table({}, {}, {}), [pd.DataFrame([RUN])], "viridis")
    path.write_text(page, encoding="utf-8")
    return path


@pytest.fixture(params=[(1440, "light")])
def page(explorer, opened, request) -> Iterator[Page]:
    """Open the explorer, by default on a wide screen, and wait until it has drawn."""
    with opened(explorer, *request.param) as page:
        settled(page)
        yield page


def settled(page: Page) -> None:
    """Wait until the page has drawn its latest settings."""
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
