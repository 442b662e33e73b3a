"""The page of old beside new in a browser: accessibility in both themes, narrow and wide."""

import pytest
from browser.conftest import SCHEMES, WIDTHS
from unit.test_compare import ELASTIC, tree

from slippulse_paper.report.compare import main

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def compared(tmp_path_factory):
    folder = tmp_path_factory.mktemp("compared")
    new = tree(folder / "new", run={"gamma": 0.3}, speed=2.0, verdict="not reproduced")
    old = tree(folder / "old", config=ELASTIC)
    assert main([str(new), str(old), str(new / "compare.html")]) == 0
    (new / "index.html").touch()
    return new / "compare.html"


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("width", WIDTHS)
def test_everybody_can_read_it(width, scheme, compared, opened, violations):
    with opened(compared, width, scheme) as page:
        assert page.locator("h1").count() == page.locator("main").count() == 1
        assert violations(page) == []
