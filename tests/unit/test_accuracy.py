"""Settings for a target error: what they are, what is refused, and that nothing changes where none is asked for."""

import math

import pytest
import tolerances as tol

import slippulse as sp
from slippulse.configuration.accuracy import promised
from slippulse.configuration.expand import expand, promise_of
from slippulse.configuration.resolve import accuracy_of, resolve
from slippulse.configuration.schema import Configuration

PULSE = {"boundary": "displacement", "gamma": 0.65, "prestress": sp.Prestress(0.5, 0.5), "damping_ratio": 0.1}
CRACK = {"boundary": "stress", "prestress": sp.Prestress(-1.0, 0.0), "damping_ratio": 0.1}


def accuracy_for(config: dict, **changes) -> dict:
    """The accuracy of a changed configuration."""
    return accuracy_of(Configuration.model_validate(config | changes))


@pytest.mark.parametrize("scene", [PULSE, CRACK], ids=["pulse", "crack"])
def test_a_smaller_error_takes_a_finer_lattice(scene):
    spacings = [sp.settings_for(accuracy, **scene)["dx"] for accuracy in (1e-2, 3e-3, 1e-3, 1e-4)]
    assert spacings == sorted(spacings, reverse=True)
    # First order where it is fine: the front speed, of second order, does not set it.
    assert spacings[2] / spacings[3] == pytest.approx(10.0, rel=tol.SHOWN_DIGITS)


def test_settings_make_a_scene_of_the_same_damping_ratio():
    settings = sp.settings_for(1e-2, **PULSE)
    plain = {key: value for key, value in PULSE.items() if key != "damping_ratio"}
    scene = sp.Scene(**plain, duration=1.0, **settings)
    assert scene.damping_ratio == pytest.approx(0.1)
    assert scene.max_step <= scene.largest_stable_step


def test_the_spacing_follows_the_scenes_own_lengths():
    def spacing(**change):
        return sp.settings_for(1e-3, **PULSE | change)["dx"]

    # Lengths in units of 1/sqrt(gamma) and W together are the same scene on another scale.
    scaled = {"gamma": 0.65 / 16.0, "prestress": sp.Prestress(0.5, 0.5, 4.0)}
    assert spacing(**scaled) == pytest.approx(4.0 * spacing(), rel=tol.SHOWN_DIGITS)
    assert spacing(prestress=sp.Prestress(0.1, 0.5)) < spacing()
    assert spacing(damping_ratio=1.0) < spacing()
    assert spacing(fields=False) > spacing()
    wide, bumped = (sp.Prestress(0.5, 0.5, 4.0, bumps=bumps) for bumps in ((), ((20.0, -0.2, 0.05),)))
    assert spacing(prestress=bumped) < spacing(prestress=wide)
    deep = sp.Prestress(-10.0, 0.0)
    assert sp.settings_for(1e-2, **CRACK | {"prestress": deep})["dx"] < sp.settings_for(1e-2, **CRACK)["dx"]


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"accuracy": 0.5}, ("accuracy: 0.5", "<= 0.1")),
        ({"accuracy": 1e-6}, ("accuracy: 1e-06", ">= 0.0001")),
        ({"accuracy": "fine"}, ("accuracy: 'fine'", "a finite number")),
        ({"damping_ratio": 3.0}, ("damping_ratio: 3.0", "<= 1")),
        ({"damping_ratio": -1.0}, ("damping_ratio: -1.0", ">= 0")),
        ({"boundary": "free"}, ("boundary: 'free'", "displacement, stress")),
        ({"release": "both"}, ("release: 'both'", "total, elastic")),
        ({"gamma": 0.0}, ("gamma: 0.0", "> 0")),
        ({"boundary": "stress"}, ("gamma: 0.65", "left out")),
    ],
)
def test_what_has_no_settings_is_refused(change, named):
    with pytest.raises(ValueError) as refusal:
        sp.settings_for(**{"accuracy": 1e-2} | PULSE | change)
    assert all(part in str(refusal.value) for part in (*named, "; allowed: "))


def test_without_an_accuracy_every_block_is_what_it_was(config):
    preset = config["presets"][config["preset"]]
    for value in ({}, {"accuracy": None}):
        accuracy = accuracy_for(config, **value)
        assert accuracy == preset | {"whole": True}
        for simulation in config["simulations"].values():
            block = resolve(simulation, config["model"], accuracy)
            assert block["accuracy"] == {key: preset[key] for key in ("dx", "max_step", "order")}
            assert promise_of(block) is None


def test_with_an_accuracy_each_scene_has_its_own_spacing(config):
    simulation = config["simulations"]["scaling_displacement"]
    accuracy = accuracy_for(config, accuracy=1e-2)
    scenes, _ = expand(promised(resolve(simulation, config["model"], accuracy)))
    for scene in scenes:
        expected = sp.settings_for(
            1e-2, boundary=scene.boundary, prestress=scene.prestress, gamma=scene.gamma,
            damping_ratio=0.1, fields="fields" in simulation["record"],
        )  # fmt: skip
        assert {key: getattr(scene, key) for key in expected} == pytest.approx(expected)
    coarser, _ = expand(promised(resolve(simulation, config["model"], accuracy, 2.0)))
    assert [scene.dx for scene in coarser] == pytest.approx([2.0 * scene.dx for scene in scenes])


@pytest.mark.parametrize(
    ("name", "own"),
    [
        ("continuum_fixed_ratio", "dx"),
        ("burridge_knopoff_speed", "spacing"),
        ("continuum_fixed_beta", "beta"),
    ],
)
def test_a_spacing_that_is_the_question_stays(config, name, own):
    simulation = dict(config["simulations"][name])
    assert own in simulation
    if own == "beta":
        simulation.pop("dx")
    before, _ = expand(resolve(simulation, config["model"], accuracy_for(config)))
    block = resolve(simulation, config["model"], accuracy_for(config, accuracy=1e-3))
    after, _ = expand(promised(block))
    assert [scene.dx for scene in after] == [scene.dx for scene in before]
    assert math.isnan(promise_of(block))
    assert all(a.max_step <= b.max_step for a, b in zip(after, before, strict=True))


def test_the_textbook_scheme_promises_nothing(config):
    model, accuracy = config["model"] | {"scheme": "fixed_step"}, accuracy_for(config, accuracy=1e-2)
    block = resolve(config["simulations"]["steady_displacement"], model, accuracy)
    with pytest.raises(ValueError, match=r"scheme: 'fixed_step'; allowed: 'localised' where accuracy"):
        promised(block)
