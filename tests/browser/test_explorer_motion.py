"""The explorer in motion: dragging, reading off and playing, without a page that jumps."""

import re
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import product

import pytest
from browser.conftest import SCHEMES, settled
from playwright.sync_api import Page, expect

pytestmark = pytest.mark.slow

# Everything that jumped, by how much of the screen and how far, from the first picture on.
WATCH = """
window.shifts = [];
const keep = (list) => window.shifts.push(...list.getEntries().map((entry) => entry.value));
new PerformanceObserver(keep).observe({ type: "layout-shift", buffered: true });
"""
LARGEST_SHIFT = 0.01
# Without 1000, the value at the end, from which playing starts again.
ABOVE_100 = re.compile(r"^(10[1-9]|1[1-9]\d|[2-9]\d\d)(\.\d*)?$")
both_widths = pytest.mark.parametrize("page", [(400, "light"), (1440, "light")], indirect=True)
reading = lambda page: page.locator("#reading").text_content()
time_of = lambda page: float(page.locator("#time").input_value())


@contextmanager
def still(page: Page) -> Iterator[None]:
    """Fail if anything on the page jumps inside the block, even right after a key press."""
    page.evaluate(WATCH)
    yield
    settled(page)
    assert sum(page.evaluate("window.shifts")) < LARGEST_SHIFT


def inside(page: Page, name: str, across: float, down: float) -> tuple[int, int]:
    """Return a pixel of a picture, given by fractions of its width and height."""
    box = page.locator(f"#{name}").bounding_box()
    return round(box["x"] + across * box["width"]), round(box["y"] + down * box["height"])


def drag(page: Page, start: tuple[int, int], end: tuple[int, int]) -> None:
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(*end, steps=8)
    settled(page)
    page.mouse.up()


def levels(page: Page) -> list[float]:
    return [float(page.locator(f"#{name}-typed").input_value()) for name in ("left", "right")]


@both_widths
def test_dragging_changes_the_pre_stress(page):
    page.locator("#prestress").scroll_into_view_if_needed()
    before = page.locator("#map").inner_html()
    with still(page):
        drag(page, inside(page, "prestress", 0.85, 0.2), inside(page, "prestress", 0.7, 0.2))
        both = levels(page)
        assert both[0] == both[1] and -0.9 < both[1] < 0.7
        assert page.locator("#map").inner_html() != before
        assert f"right={both[1]:g}" in page.url
    page.locator("#alike").uncheck()
    # Negative levels move nothing else on the page.
    with still(page):
        drag(page, inside(page, "prestress", 0.7, 0.8), inside(page, "prestress", 0.45, 0.8))
        left, right = levels(page)
        assert left < 0.0 and right == both[1]
        drag(page, inside(page, "prestress", 0.7, 0.2), inside(page, "prestress", 0.45, 0.2))
        assert max(levels(page)) < 0.0


def test_the_pointer_reads_the_map(page):
    with still(page):
        said = []
        for across, down in ((0.1, 0.15), (0.2, 0.5), (0.9, 0.45)):
            page.mouse.move(*inside(page, "map", across, down))
            said.append(reading(page))
    assert "not yet released" in said[0]
    assert re.search(r"slides, slip velocity \d", said[1])
    assert "stuck again" in said[2]
    page.mouse.move(5, 5)
    assert reading(page) not in said
    page.mouse.click(*inside(page, "map", 0.2, 0.5))
    page.mouse.move(5, 5)
    assert reading(page) == said[1]


def test_the_keyboard_reads_the_map(page):
    page.locator("#time").press("Home")
    assert "t = 0, x = 0: not yet released" in reading(page)
    for _ in range(3):
        page.locator("#time").press("PageUp")
    assert "slides" in reading(page)
    page.locator("#place").press("Home")
    assert "not yet released" in reading(page)
    assert page.locator("#place").get_attribute("aria-valuetext") in reading(page)


def test_readings_and_blocks_are_the_exact_solution_and_blocks_keep_their_order(page):
    # The time is that of the end, where blocks have slipped most.
    heights = page.locator("#blocks rect.block").evaluate_all(
        "blocks => blocks.map((block) => Number(block.getAttribute('y')))"
    )
    page.locator("#time").fill("200")
    said = re.search(r"velocity ([0-9.]+), slip ([0-9.]+)\.", reading(page)).groups()
    exact, found = page.evaluate(
        """() => {
            const { map, scene, rupture } = shown;
            const instant = 0.2 * settings.end, time = 0.5 * scene.end;
            const blocks = [0, 2.5, -6, 30].map((x) => {
                const { slip, velocity, state } = blockAt(map, x, time);
                const stick = x === 30 ? Infinity : rupture.stick(x, scene.end);
                const exact = x === 30 ? 0 : rupture.slip(x, Math.min(time, stick));
                return { slip, velocity, state, exact };
            });
            return [[rupture.velocity(0, instant), rupture.slip(0, instant)], blocks];
        }"""
    )
    assert [float(number) for number in said] == pytest.approx(exact, rel=5e-3)
    assert [block["state"] for block in found] == ["stuck", "stuck", "slides", "waits"]
    for block in found:
        assert block["slip"] == pytest.approx(block["exact"], rel=2e-2, abs=1e-9)
        assert (block["velocity"] > 0.0) == (block["state"] == "slides")
    assert heights == sorted(heights, reverse=True)


def test_play_advances_pauses_and_starts_again(page):
    page.locator("#time").press("End")
    drawn = page.locator("#blocks").inner_html()
    play = page.locator("#play")
    with still(page):
        play.press("Enter")
        assert play.text_content() == "Pause"
        # The policy of the page allows no function that a test would bring along.
        expect(page.locator("#time")).to_have_value(ABOVE_100)
        assert page.locator("#blocks").inner_html() != drawn
        play.press("Enter")
        assert play.text_content() == "Play"
        paused = time_of(page)
        page.wait_for_timeout(200)
        assert paused == time_of(page) < 1000
    page.locator("#time").fill("990")
    play.press("Enter")
    expect(page.locator("#play")).to_have_text("Play", timeout=30_000)
    assert time_of(page) == 1000


def test_little_motion_is_asked_for_and_given(page):
    page.emulate_media(reduced_motion="reduce")
    page.reload()
    settled(page)
    page.evaluate(
        """() => {
            window.times = [];
            const drawn = drawBlocks;
            drawBlocks = (found, time) => { window.times.push(time); drawn(found, time); };
        }"""
    )
    page.locator("#play").press("Enter")
    page.wait_for_timeout(1800)
    times = page.evaluate("window.times")
    assert 2 <= len(times) <= 5


@both_widths
def test_the_map_stays_in_view_of_every_slider(page):
    page.locator("#end").scroll_into_view_if_needed()
    for part in ("map", "play"):
        box = page.locator(f"#{part}").bounding_box()
        assert box["y"] >= -1.0 and box["y"] + box["height"] < 844, part


def test_on_a_wide_screen_no_column_is_left_empty(page):
    heights = [page.locator(f".{part}").bounding_box()["height"] for part in ("view", "controls")]
    assert max(heights) < 1.35 * min(heights)
    tops = [page.locator(f"#{name}").bounding_box()["y"] for name in ("velocity", "slip", "speeds")]
    assert max(tops) - min(tops) < 1.0
    assert tops[0] > page.locator(".controls").bounding_box()["y"] + max(heights)


@pytest.mark.parametrize("page", [*product((400, 1440), SCHEMES)], indirect=True)
def test_it_is_accessible_at_rest_and_while_it_plays(page, violations):
    assert violations(page) == []
    page.locator("#play").press("Enter")
    page.locator("details summary").press("Enter")
    assert violations(page) == []
