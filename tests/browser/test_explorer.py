"""The explorer has the numbers of the theory, and its settings work by keyboard and address."""

import numpy as np
import pandas as pd
import pytest
from browser.conftest import RUN, settled
from tolerances import EXPLORER, EXPLORER_SPEED

from slippulse.model.prestress import Prestress
from slippulse.theory import Rupture, front_speed, steady_pulse
from slippulse_paper.report.explorer_page import simulated_runs
from slippulse_paper.studies import explorer_law

pytestmark = pytest.mark.slow

# Names of the sliders of the explorer, in the order of the page.
SLIDERS = ["beta", "dx", "left", "right", "width", "gamma", "alpha", "end"]
SCENE = dict(left=0.5, right=0.5, gamma=0.65, width=1.0, ratio=0.1, release="total", end=20.0)


def press(page, where: str, key: str) -> None:
    page.locator(where).press(key)
    settled(page)


def random_scene(random: np.random.Generator, k: int) -> dict:
    """Return a random scene: half are symmetric, half have each rule, and a fifth no damping."""
    left, right = random.uniform(0.05, 0.95, 2).tolist()
    least, most = np.log([2e-3, 0.02, 0.2]), np.log([explorer_law.LARGEST_RATIO, 2.0, 5.0])
    ratio, gamma, width = np.exp(random.uniform(least, most)).tolist()
    ratio = ratio if k % 5 else 0
    scene = dict(left=left, right=left if k % 2 else right, gamma=gamma, width=width, ratio=ratio)
    return scene | {"release": "total" if k % 4 < 2 else "elastic"}


def test_its_numbers_are_those_of_the_library(page):
    random = np.random.default_rng(16)
    scenes = [random_scene(random, k) for k in range(200)]
    shown = page.evaluate(
        """scenes => scenes.map((scene) => {
            const v = 1 / frontLaw(DATA.law, scene.ratio, scene.release)(1 - scene.left);
            const steady = steadyPulse({ ...scene, right: scene.left, beta: 0.1 * scene.ratio }, v);
            const rupture = new Rupture(scene, DATA.law);
            const first = rupture.transition();
            const pulse = rupture.pulse(3 * first.transitionTime, first.firstStick);
            const numbers = { ...first, ...pulse, slipCentre: rupture.slip(0, rupture.stick(0)) };
            return [[v, steady.slip, steady.width], numbers];
        })""",
        scenes,
    )
    for scene, (steady, numbers) in zip(scenes, shown, strict=True):
        law = scene["ratio"], scene["release"]
        speed = front_speed(scene["left"], *law)
        pulse = steady_pulse(scene["left"], scene["gamma"], 0.1 * scene["ratio"], steady[0])
        sizes = [speed, pulse.slip, pulse.width]
        assert steady == pytest.approx(sizes, rel=EXPLORER_SPEED), scene
        prestress = Prestress(scene["left"], scene["right"], scene["width"])
        # The pulse is read at the time and position that the page found.
        rupture = Rupture(prestress, scene["gamma"], *law, 1.001 * numbers["time"])
        exact = {
            "speed": front_speed(scene["right"], *law),
            "speedLeft": speed,
            "transitionTime": rupture.transition.time,
            "transitionLength": rupture.transition.length,
            "width": rupture.pulse_width(numbers["time"]),
            "slip": float(rupture.final_slip(numbers["edge"])),
            "slipCentre": float(rupture.final_slip(0.0)),
        }
        assert {name: numbers[name] for name in exact} == pytest.approx(exact, rel=EXPLORER), scene


def test_fronts_into_negative_pre_stress_are_those_of_the_library(page):
    cases = [(-0.5, 0.5, 0.65, 0.0), (0.7, -0.3, 0.65, 0.0), (-0.2, -0.4, 0.65, 0.0)]
    cases += [(-0.5, 0.5, 0.65, 0.5), (-0.5, 0.0, 0.0, 0.0), (-0.3, -0.5, 0.0, 0.0)]
    cases.append((-0.5, 0.2, 0.0, 0.5))
    names = ("left", "right", "gamma", "alpha")
    scenes = [SCENE | dict(zip(names, case, strict=True)) | {"end": 12.0} for case in cases]
    shown = page.evaluate(
        """scenes => scenes.map((scene) => {
            const rupture = new Rupture(scene, DATA.law);
            const stopped = [rupture.left, rupture.right].map(
                (front) => Boolean(front.slow && front.slow.stopped));
            return [[0.3, 0.6, 1].flatMap((part) => rupture.fronts(part * scene.end)), stopped];
        })""",
        scenes,
    )
    for scene, (fronts, stopped) in zip(scenes, shown, strict=True):
        prestress = Prestress(scene["left"], scene["right"])
        exact = Rupture(prestress, scene["gamma"], 0.1, "total", scene["end"], 1, scene["alpha"])
        positions = np.ravel([exact.fronts_at(part * scene["end"]) for part in (0.3, 0.6, 1.0)])
        assert fronts == pytest.approx(positions.tolist(), rel=EXPLORER), scene
        assert stopped == [end.reason == "stops" for end in exact.front_ends[0]]


def test_the_rate_term_delays_the_first_stick_and_ends_pulses_where_it_should(page):
    rates = [-0.3, 0.0, 0.4, 0.7, 0.9]
    times = page.evaluate(
        """scenes => scenes.map(
            (scene) => new Rupture(scene, DATA.law).transition().transitionTime)""",
        [SCENE | {"alpha": alpha} for alpha in rates],
    )
    slip, critical, exists_below, exists_above = page.evaluate(
        """scene => {
            const v = 1 / frontLaw(DATA.law, scene.ratio, scene.release)(0.5);
            const critical = criticalRate(scene.gamma, v);
            const pulse = (alpha) => steadyPulse({ ...scene, beta: 0, alpha: alpha }, v);
            const exists = [0.99, 1.01].map((part) => pulse(part * critical) !== null);
            return [pulse(0.4).slip, critical, ...exists];
        }""",
        SCENE,
    )
    ruptures = [Rupture(Prestress(0.5, 0.5), 0.65, 0.1, "total", 20.0, 1, alpha) for alpha in rates]
    exact = [rupture.transition.time for rupture in ruptures]
    assert times == pytest.approx(exact, rel=EXPLORER_SPEED)
    assert [slip, critical] == pytest.approx([0.94727, 0.9473], rel=5e-5)
    assert exists_below and not exists_above


def test_beta_over_dx_alone_sets_the_speed_and_axes_stand_still(page):
    def speed() -> str:
        settled(page)
        return page.locator("#exact tbody tr td").first.text_content()

    def axes() -> list[str]:
        texts = page.locator("#map > text, #velocity > text, #slip > text").all_text_contents()
        return [text for text in texts if "trans" not in text]

    first, drawn = speed(), axes()
    finer, both = page.locator("[data-story]").all()[1:]
    finer.press("Enter")
    assert float(speed()) > float(first)
    assert page.locator("#map .ghost").count() == 1
    both.press("Enter")
    assert speed() == first
    assert page.locator("#ratio").text_content() == "0.1"
    press(page, "#gamma", "End")
    assert axes() == drawn


def test_every_slider_is_reached_by_keyboard(page):
    reached = []
    for _ in range(40):
        page.keyboard.press("Tab")
        reached.append(page.evaluate("document.activeElement.id"))
    assert [name for name in reached if name in SLIDERS] == SLIDERS


@pytest.mark.parametrize("name", SLIDERS)
def test_every_setting_works_by_keyboard_and_typed(page, name):
    slider, typed = page.locator(f"#{name}"), page.locator(f"#{name}-typed")
    assert page.locator(f"label[for={name}]").text_content()
    assert typed.get_attribute("aria-label")
    values, pictures = {typed.input_value()}, {page.locator("#map").inner_html()}
    for key in ("ArrowLeft", "End", "Home"):
        press(page, f"#{name}", key)
        values.add(typed.input_value())
        pictures.add(page.locator("#map").inner_html())
        assert f"{name}={float(typed.input_value()):g}" in page.url
    # Spacing and damping at the end of their range may give the b that there was.
    assert len(values) == 4 and len(pictures) >= 3
    typed.fill("0.4")
    press(page, f"#{name}-typed", "Enter")
    assert slider.get_attribute("aria-valuetext") == typed.input_value()


def test_an_address_holds_every_setting(page, explorer):
    address = "left=0.32&right=0.32&width=1&gamma=0.5&beta=0.001&dx=0.01&alpha=0&end=12"
    page.goto(f"{explorer.as_uri()}#{address}&release=elastic&held=false")
    page.reload()
    settled(page)
    assert page.locator("[name=held]:checked").get_attribute("value") == "false"
    assert not page.locator("#simulated").is_visible()
    page.locator("[name=held][value=true]").check()
    page.locator("[name=release][value=total]").check()
    settled(page)
    assert "here 0.32" in page.locator("#nearest").text_content()
    press(page, "#visit", "Enter")
    shown = [page.locator(f"#{name}-typed").input_value() for name in SLIDERS[:6]]
    assert shown == ["0.001", "0.01", "0.3", "0.3", "1", "0.5"]


def test_only_runs_that_the_page_can_compute_are_shown():
    others = [{"boundary": "stress"}, {"left": 0.2}, {"left": -0.3, "right": -0.3}]
    others += [{"steps_and_bumps": '{"steps": [[1.0, 0.2]], "bumps": []}'}, {"damping_ratio": 6.0}]
    rows = [RUN, *(RUN | other for other in others), RUN | {"pulse_state": "unsteady"}]
    runs = simulated_runs(pd.DataFrame(rows), explorer_law.LARGEST_RATIO)
    settings = [0.3, 0.5, 1.0, 1e-3, 0.1, "total", 1.1, 4.1, 10.1]
    assert runs == [[*settings, 1.11], [*settings, None]]
