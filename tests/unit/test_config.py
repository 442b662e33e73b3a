"""The shipped configuration, settings for a target error, and bounds on the cost of a run."""

import math
from dataclasses import replace

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp
from slippulse.model.cost import bound_cost
from slippulse_paper.configuration.expand import expand
from slippulse_paper.configuration.promised_spacings import with_promised_spacings
from slippulse_paper.configuration.resolve import accuracy_of, resolve
from slippulse_paper.configuration.schema import Configuration

PULSE = {"boundary": "displacement", "gamma": 0.65, "damping_ratio": 0.1}
PULSE["prestress"] = sp.Prestress(0.5, 0.5)
CRACK = {"boundary": "stress", "prestress": sp.Prestress(-1.0, 0.0), "damping_ratio": 0.1}

accuracy_for = lambda config, **to: accuracy_of(Configuration.model_validate(config | to))
ASKED = {"continuum_fixed_ratio": "dx", "burridge_knopoff_speed": "spacing"}
ASKED |= {"continuum_fixed_beta": "beta"}


def scenes_of(shipped: dict, name: str, coarser: float = 1.0):
    simulation, accuracy = shipped["simulations"][name], shipped["presets"]["paper"]
    sweep = resolve(simulation, shipped["model"], accuracy) | {"coarser": coarser}
    return sweep, expand(sweep)[0]


def test_sweeps_are_products_of_their_lists_and_cover_the_paper(shipped):
    sweep, scenes = scenes_of(shipped, "scaling_stress")
    assert len(scenes) == len(sweep["left"]) * len(sweep["width"]) >= 60
    assert {scene.prestress.left for scene in scenes} == set(sweep["left"])
    assert all(scene.damping_ratio == pytest.approx(0.1) for scene in scenes)
    _, (scene,) = scenes_of(shipped, "space_time_displacement")
    assert (scene.dx, scene.beta) == (0.01, pytest.approx(1e-3))
    assert (scene.prestress.left, scene.gamma, scene.release) == (0.25, 0.55, "total")
    springs = shipped["simulations"]["scaling_displacement"]
    assert min(springs["left"]) <= 0.1 and max(springs["left"]) >= 0.9
    assert min(springs["gamma"]) <= 1e-3 and max(springs["gamma"]) >= 1.0
    assert len(springs["left"]) * len(springs["gamma"]) >= 60
    assert min(sweep["left"]) <= -2.0 and max(sweep["left"]) >= -0.1
    assert min(sweep["width"]) <= 0.5 and max(sweep["width"]) >= 16.0
    for name in ("damping_displacement", "damping_stress"):
        ratios = sorted(shipped["simulations"][name]["damping_ratio"])
        assert ratios[0] == 0.0 < ratios[1] and ratios[-1] / ratios[1] >= 100.0
        assert len(ratios) >= 5
    # A coarser lattice keeps the damping ratio.
    fine, coarse = (scenes_of(shipped, "steady_displacement", factor)[1] for factor in (1.0, 2.0))
    for a, b in zip(fine, coarse, strict=True):
        numbers = 2.0 * a.dx, a.damping_ratio, a.duration
        assert (b.dx, b.damping_ratio, b.duration) == pytest.approx(numbers)


PLAIN = {"boundary": "displacement", "prestress": sp.Prestress(0.5, 0.5), "gamma": 0.65}
PLAIN |= {"duration": 5.0, "dx": 0.1, "max_step": 1e-6}
# Scenes at the ends of the ranges; others are in verification/test_random_scenes.py.
EXTREMES = [{"gamma": 1e5}, {"gamma": 1e-8, "dx": 0.01}, {"beta": 1e3, "duration": 0.1}]
EXTREMES += [{"release": "elastic", "beta": 10.0}, {"scheme": "fixed_step", "beta": 10.0}]
EXTREMES += [{"prestress": sp.Prestress(*levels)} for levels in ((-100.0, 0.9), (0.0, 0.9999))]
EXTREMES += [{"prestress": sp.Prestress(0.3, 0.3, 1e3)}, {"order": 3}]
# Undamped blocks that slip again and again cut steps short, here 40,000: no pre-stress, and a
# nucleation as wide as a block.
AGAIN = {"prestress": sp.Prestress(0.0, 0.0, 0.76), "duration": 400.0, "dx": 0.76, "gamma": 8e-8}
EXTREMES.append(AGAIN | {"order": 8})


@pytest.mark.parametrize("change", EXTREMES, ids=str)
def test_a_run_exceeds_its_cost_bound_at_most_by_a_small_factor(change):
    scene = sp.Scene(**PLAIN | change)
    scene = replace(scene, max_step=min(1.0, 0.9 * scene.largest_stable_step))
    bound, run = bound_cost(scene), sp.simulate(scene)
    assert run.attrs["block_updates"] < tol.BOUND_FACTOR * bound.block_updates
    assert run.nbytes < bound.bytes
    assert scene.dx != 0.76 or run.attrs["re_releases"] > 10_000


def test_a_run_that_would_not_end_is_refused_before_it_starts():
    profile = sp.Prestress(0.6, 0.6)
    allowed = "allowed: 4e.[0-9]+; use run_sweep, which has no limit of cost"
    with pytest.raises(ValueError, match=rf"^cost: up to 8.*e.22 block updates; {allowed}$"):
        sp.simulate(sp.Scene("stress", profile, 1e9, dx=0.01))
    samples = sp.Samples(np.linspace(0.0, 1.0, 30_000), np.linspace(-1.0, 1.0, 30_000))
    with pytest.raises(ValueError, match=f"^cost: up to .* bytes; {allowed}$"):
        sp.simulate(sp.Scene("stress", profile, 1.0, dx=0.01), samples)
    # The exact solution has a limit of its own.
    with pytest.raises(
        ValueError, match="allowed: a shorter distance, with at most 20000 integration panels"
    ):
        sp.theory.Rupture(profile, 0.65, duration=1e6)
    rupture = sp.theory.Rupture(sp.Prestress(0.6, 0.5), 0.65, 0.1, duration=5e4)
    refusal = "^duration: 50000; .* the slip velocity must be evaluated at 1.3e.10 points"
    with pytest.raises(ValueError, match=refusal):
        _ = rupture.first_stick


@pytest.mark.parametrize("scene", [PULSE, CRACK], ids=["pulse", "crack"])
def test_a_smaller_error_takes_a_finer_lattice_at_the_same_damping_ratio(scene):
    scenes = []
    for error in (1e-2, 3e-3, 1e-3, 1e-4):
        settings = scene | {"duration": 1.0} | sp.settings_for(error, **scene)
        del settings["damping_ratio"]
        scenes.append(sp.Scene(**settings))
    spacings = [scene.dx for scene in scenes]
    assert spacings == sorted(spacings, reverse=True)
    # A fine spacing is of first order: the front speed, of second order, does not set it.
    assert spacings[2] / spacings[3] == pytest.approx(10.0, rel=tol.SHOWN_DIGITS)
    assert [scene.damping_ratio for scene in scenes] == pytest.approx([0.1] * 4)
    assert all(scene.max_step <= scene.largest_stable_step for scene in scenes)


def test_the_spacing_follows_the_lengths_of_the_scene():
    spacing = lambda **change: sp.settings_for(1e-3, **PULSE | change)["dx"]
    # Lengths in units of 1/sqrt(gamma) and W together are the same scene on another scale.
    scaled = {"gamma": 0.65 / 16.0, "prestress": sp.Prestress(0.5, 0.5, 4.0)}
    assert spacing(**scaled) == pytest.approx(4.0 * spacing(), rel=tol.SHOWN_DIGITS)
    assert spacing(prestress=sp.Prestress(0.1, 0.5)) < spacing()
    assert spacing(damping_ratio=1.0) < spacing()
    assert spacing(fields=False) > spacing()
    wide = sp.Prestress(0.5, 0.5, 4.0)
    bumped = sp.Prestress(0.5, 0.5, 4.0, bumps=((20.0, -0.2, 0.05),))
    assert spacing(prestress=bumped) < spacing(prestress=wide)
    deep = CRACK | {"prestress": sp.Prestress(-10.0, 0.0)}
    assert sp.settings_for(1e-2, **deep)["dx"] < sp.settings_for(1e-2, **CRACK)["dx"]


def test_the_spacing_follows_where_a_table_falls_to_zero():
    spacing = lambda profile: sp.settings_for(1e-2, **CRACK | {"prestress": profile})["dx"]
    # A table with the levels of the scene below its Gaussian is the same pre-stress.
    levels = sp.Prestress.through([-9.0, 0.0, 0.0, 9.0], [-0.5, -0.5, 0.0, 0.0], width=1.0)
    assert spacing(levels) == spacing(sp.Prestress(-0.5, 0.0))
    # A straight line falls to 0 before the next point of the table.
    coarse = sp.Prestress.through([-30.0, -1.0, 0.0, 1.0, 2.0], [-3.0, 0.2, 1.2, 0.2, 0.0])
    x = np.linspace(-30.0, 2.0, 321)
    assert spacing(coarse) == pytest.approx(
        spacing(sp.Prestress.through(x, coarse(x))), rel=tol.SHOWN_DIGITS
    )
    box = sp.Prestress.through([-9.0, -1.0, -1.0, 0.5, 0.5, 9.0], [-0.5, -0.5, 1.2, 1.2, 0.0, 0.0])
    assert spacing(box) > 1e-3


def test_without_an_accuracy_no_spacing_changes(config):
    preset, accuracy = config["presets"][config["preset"]], accuracy_for(config)
    assert accuracy == accuracy_for(config, accuracy=None) == preset | {"whole": True}
    for simulation in config["simulations"].values():
        block = resolve(simulation, config["model"], accuracy)
        assert block["accuracy"] == {key: preset[key] for key in ("dx", "max_step", "order")}


def test_with_an_accuracy_each_scene_has_its_own_spacing_but_not_by_the_textbook_scheme(config):
    simulation = config["simulations"]["scaling_displacement"]
    accuracy = accuracy_for(config, accuracy=1e-2)
    scenes, _ = expand(with_promised_spacings(resolve(simulation, config["model"], accuracy)))
    for scene in scenes:
        physics = {"boundary": scene.boundary, "prestress": scene.prestress, "gamma": scene.gamma}
        fields = "fields" in simulation["record"]
        expected = sp.settings_for(1e-2, **physics, damping_ratio=0.1, fields=fields)
        assert {key: getattr(scene, key) for key in expected} == pytest.approx(expected)
    block = resolve(simulation, config["model"], accuracy) | {"coarser": 2.0}
    coarser, _ = expand(with_promised_spacings(block))
    assert [scene.dx for scene in coarser] == pytest.approx([2.0 * scene.dx for scene in scenes])
    model = config["model"] | {"scheme": "fixed_step"}
    accuracy = accuracy_for(config, accuracy=1e-2)
    block = resolve(config["simulations"]["steady_displacement"], model, accuracy)
    with pytest.raises(ValueError, match="scheme: 'fixed_step'; allowed: 'localised' if acc"):
        with_promised_spacings(block)


@pytest.mark.parametrize("name", ASKED)
def test_a_spacing_under_study_is_not_changed(config, name):
    simulation = dict(config["simulations"][name])
    assert ASKED[name] in simulation
    if "beta" in simulation:
        simulation.pop("dx")
    before, _ = expand(resolve(simulation, config["model"], accuracy_for(config)))
    block = resolve(simulation, config["model"], accuracy_for(config, accuracy=1e-3))
    after, _ = expand(with_promised_spacings(block))
    assert [scene.dx for scene in after] == [scene.dx for scene in before]
    assert math.isnan(block["accuracy"]["promise"])
    assert all(a.max_step <= b.max_step for a, b in zip(after, before, strict=True))
