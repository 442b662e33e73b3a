"""The explorer alone: its numbers are those of the theory, and it works by keyboard, on a phone and in the dark."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from browser.conftest import SCHEMES, WIDTHS
from tolerances import EXPLORER, EXPLORER_SPEED

from slippulse.model.prestress import Prestress
from slippulse.report.explorer_page import explorer_page, simulated_runs
from slippulse.studies import explorer_law
from slippulse.theory import Rupture, front_speed, steady_pulse

# All by `make test-pages`, which opens the other pages too.
pytestmark = pytest.mark.slow

# Each with the ends of its range, within which the scenes below lie.
SLIDERS = {
    "beta": '"1e-4", "1e-2"', "dx": '"2e-3", "5e-2"', "left": '"0.05", "0.95"', "right": '"0.05", "0.95"',
    "width": '"0.2", "5"', "gamma": '"0.02", "2"',
}  # fmt: skip
RUN = {
    "boundary": "displacement", "left": 0.3, "right": 0.3, "width": 1.0, "peak": 1.0, "gamma": 0.5, "beta": 1e-3,
    "steps_and_bumps": '{"steps": [], "bumps": []}', "damping_ratio": 0.1, "release": "total",
    "front_speed_right": 1.1, "transition_time": 4.1, "transition_length": 10.1, "pulse_slip": 1.11,
    "pulse_state": "steady",
}  # fmt: skip


@pytest.fixture(scope="module")
def law() -> pd.DataFrame:
    return explorer_law.table({}, {}, {})


@pytest.fixture(scope="module")
def file(law, tmp_path_factory):
    path = tmp_path_factory.mktemp("explorer") / "explorer.html"
    # The way back leads somewhere.
    path.with_name("index.html").touch()
    path.write_text(explorer_page(law, [pd.DataFrame([RUN])]), encoding="utf-8")
    return path


def settled(page) -> None:
    """Wait until the page has drawn what it was told."""
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")


def random_scenes(count: int) -> list[dict]:
    """Settings over the whole reach of the sliders, half of them symmetric, a fifth undamped, both rules."""
    random = np.random.default_rng(16)

    def between(low: float, high: float) -> float:
        return float(np.exp(random.uniform(np.log(low), np.log(high))))

    scenes = []
    for k in range(count):
        left, right = random.uniform(0.05, 0.95, 2).tolist()
        ratio = 0.0 if k % 5 == 0 else between(2e-3, explorer_law.LARGEST_RATIO)
        scenes.append(
            {
                "left": left, "right": left if k % 2 else right, "gamma": between(0.02, 2.0),
                "width": between(0.2, 5.0), "ratio": ratio, "release": "total" if k % 4 < 2 else "elastic",
            }
        )  # fmt: skip
    return scenes


def test_its_numbers_are_those_of_the_library(file, opened):
    scenes = random_scenes(200)
    with opened(file) as page:
        found = page.evaluate(
            """scenes => scenes.map((scene) => {
                const rupture = new Rupture(scene, DATA.law);
                const first = rupture.transition();
                const pulse = rupture.pulse(MULTIPLE * first.transitionTime, first.firstStick);
                return { ...first, ...pulse, slipCentre: rupture.slip(0, rupture.stick(0)) };
            })""",
            scenes,
        )
    for scene, numbers in zip(scenes, found, strict=True):
        ratio, release = scene["ratio"], scene["release"]
        prestress = Prestress(scene["left"], scene["right"], scene["width"])
        # The pulse is read at the time and position that the page found.
        rupture = Rupture(prestress, scene["gamma"], ratio, release, 1.001 * numbers["time"])
        exact = {
            "speed": front_speed(scene["right"], ratio, release),
            "speedLeft": front_speed(scene["left"], ratio, release),
            "transitionTime": rupture.transition_time,
            "transitionLength": rupture.transition_length,
            "width": rupture.pulse_width(numbers["time"]),
            "slip": float(rupture.final_slip(numbers["edge"])),
            "slipCentre": float(rupture.final_slip(0.0)),
        }
        assert {name: numbers[name] for name in exact} == pytest.approx(exact, rel=EXPLORER), scene


def test_its_front_law_and_damped_pulse_are_those_of_the_library(file, opened):
    scenes = random_scenes(400)
    with opened(file) as page:
        found = page.evaluate(
            """scenes => scenes.map((s) => {
                const v = 1 / frontLaw(DATA.law, s.ratio, s.release)(1 - s.right);
                return [v, steadySlip({ ...s, beta: 0.1 * s.ratio }, v)];
            })""",
            scenes,
        )
    for scene, (speed, slip) in zip(scenes, found, strict=True):
        exact = front_speed(scene["right"], scene["ratio"], scene["release"])
        assert speed == pytest.approx(exact, rel=EXPLORER_SPEED), scene
        pulse = steady_pulse(scene["left"], scene["gamma"], 0.1 * scene["ratio"], speed)
        assert slip == pytest.approx(pulse.slip, rel=EXPLORER_SPEED), scene


def test_beta_over_dx_alone_sets_the_speed(file, opened):
    with opened(file) as page:

        def speed() -> str:
            settled(page)
            return page.locator("#exact tbody tr td").first.text_content()

        first = speed()
        finer, both = page.locator("[data-beta]").all()[1:3]
        finer.press("Enter")
        assert float(speed()) > float(first)
        both.press("Enter")
        assert speed() == first
        assert page.locator("#ratio").text_content() == "0.1"


def test_sliders_are_named_and_work_by_keyboard_in_order_and_the_nearest_run_sets_them(file, opened, project):
    template = (project / "src/slippulse/report/templates/explorer.html").read_text("utf-8")
    with opened(file) as page:
        reached = []
        for _ in range(20):
            page.keyboard.press("Tab")
            reached.append(page.evaluate("document.activeElement.id"))
        assert [name for name in reached if name in SLIDERS] == list(SLIDERS)
        for name, ends in SLIDERS.items():
            assert ends in template
            page.reload()
            slider, shown = page.locator(f"#{name}"), page.locator(f"#{name}-shown")
            assert page.locator(f"label[for={name}]").text_content()
            values, pictures = {shown.text_content()}, {page.locator("#map").inner_html()}
            for key in ("ArrowRight", "End", "Home"):
                slider.press(key)
                settled(page)
                assert slider.get_attribute("aria-valuetext") == shown.text_content()
                values.add(shown.text_content())
                pictures.add(page.locator("#map").inner_html())
            # Spacing and damping at the end of their range may give the b that there was.
            assert len(values) == 4 and len(pictures) >= 3, name
        page.locator("#visit").press("Enter")
        settled(page)
        shown = [page.locator(f"#{name}-shown").text_content() for name in SLIDERS]
        assert shown == ["0.001", "0.01", "0.3", "0.3", "1", "0.5"]


@pytest.mark.parametrize("scheme", SCHEMES)
@pytest.mark.parametrize("width", WIDTHS)
def test_everybody_can_use_it(width, scheme, file, opened, violations):
    with opened(file, width, scheme) as page:
        settled(page)
        assert violations(page) == []


def test_without_a_run_to_compare_with_there_is_no_comparison(law, tmp_path, opened):
    (tmp_path / "explorer.html").write_text(explorer_page(law, []), encoding="utf-8")
    with opened(tmp_path / "explorer.html") as page:
        settled(page)
        assert page.locator("#exact tbody tr").count() == 6
        assert not page.locator("#simulated").is_visible()


def test_only_runs_that_the_page_can_compute_are_shown():
    others = [
        RUN | {"boundary": "stress"}, RUN | {"left": 0.2}, RUN | {"left": -0.3, "right": -0.3},
        RUN | {"steps_and_bumps": '{"steps": [[1.0, 0.2]], "bumps": []}'}, RUN | {"damping_ratio": 6.0},
    ]  # fmt: skip
    unsteady = RUN | {"pulse_state": "unsteady"}
    runs = simulated_runs(pd.DataFrame([RUN, *others, unsteady]), explorer_law.LARGEST_RATIO)
    settings = [0.3, 0.5, 1.0, 1e-3, 0.1, "total", 1.1, 4.1, 10.1]
    assert runs == [[*settings, 1.11], [*settings, None]]
