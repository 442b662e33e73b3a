"""The configuration: the shipped one is accepted, mistakes are refused in one line that names key, value and remedy."""

from __future__ import annotations

import pytest

from slippulse.configuration.expand import ConfigError, expand, resolve
from slippulse.configuration.validate import validate


@pytest.mark.parametrize("preset", ["draft", "paper", "reference"])
def test_every_preset_is_accepted(config, preset):
    config["preset"] = preset
    validate(config)


def at(config: dict, path: str, value) -> None:
    """Set a value at a dotted path."""
    *parents, last = path.split(".")
    for key in parents:
        config = config[key]
    config[last] = value


SIMULATION = "simulations.scaling_displacement"
MISTAKES = [
    ("presets.paper.dxx", 0.1, ("presets.paper.dxx", "did you mean 'dx'", "allowed")),
    ("preset", "papre", ("preset", "'papre'", "draft, paper, reference")),
    ("presets.paper.dx", "1e-3", ("presets.paper.dx", "'1e-3'", "1.0e-3")),
    ("presets.paper.dx", -0.1, ("presets.paper.dx", "-0.1", "> 0")),
    ("presets.paper.max_step", 3.0, ("max_step",)),
    ("model.release", "both", ("model.release", "'both'", "total, elastic")),
    (f"{SIMULATION}.gama", [0.1], (f"{SIMULATION}.gama", "did you mean 'gamma'")),
    (f"{SIMULATION}.gamma", [], (f"{SIMULATION}.gamma", "at least one")),
    (f"{SIMULATION}.gamma", [0.1, 0.1], (f"{SIMULATION}.gamma", "different")),
    (f"{SIMULATION}.gamma", [0.0], (f"{SIMULATION}.gamma.0", "> 0")),
    (f"{SIMULATION}.duration", {"time": 1.0, "half_periods": 2.0}, (f"{SIMULATION}.duration", "one of time")),
    ("simulations.scaling_stress.gamma", [0.5], ("scaling_stress.gamma", "left out under boundary 'stress'")),
    ("simulations.burridge_knopoff_stress.width", [0.5], ("prestress.width", "0.5", ">= dx")),
    ("simulations.scaling_stress.duration", {"half_periods": 1.0}, ("duration.half_periods", "displacement")),
    ("measure.share", 1.5, ("measure.share", "1.5", "between 0 and 1")),
]


@pytest.mark.parametrize(("path", "value", "named"), MISTAKES, ids=[f"{m[0]}={m[1]}" for m in MISTAKES])
def test_a_mistake_is_named(config, path, value, named):
    at(config, path, value)
    if path == "presets.paper.max_step":
        # The preset's step is cut to the bound by itself; a block's own step is refused.
        at(config, f"{SIMULATION}.max_step", value)
    with pytest.raises(ConfigError) as refusal:
        validate(config)
    for part in named:
        assert part in str(refusal.value)


def test_a_sweep_is_the_product_of_its_lists(config):
    block = resolve(config["simulations"]["scaling_stress"], config["model"], config["presets"]["paper"])
    scenes, _ = expand(block)
    assert len(scenes) == len(block["left"]) * len(block["width"]) >= 60
    assert {scene.prestress.left for scene in scenes} == set(block["left"])
    assert all(scene.damping_ratio == pytest.approx(0.1) for scene in scenes)


def test_a_coarser_lattice_keeps_the_damping_ratio(config):
    simulation = config["simulations"]["steady_displacement"]
    fine, _ = expand(resolve(simulation, config["model"], config["presets"]["paper"]))
    coarse, _ = expand(resolve(simulation, config["model"], config["presets"]["paper"], 2.0))
    for a, b in zip(fine, coarse, strict=True):
        assert b.dx == pytest.approx(2.0 * a.dx)
        assert b.damping_ratio == pytest.approx(a.damping_ratio)
        assert b.duration == a.duration


def test_the_paper_preset_is_the_published_lattice(config):
    block = resolve(
        config["simulations"]["space_time_displacement"], config["model"], config["presets"]["paper"]
    )
    (scene,), _ = expand(block)
    assert (scene.dx, scene.beta) == (0.01, pytest.approx(1e-3))
    assert (scene.prestress.left, scene.gamma, scene.release) == (0.25, 0.55, "total")


def test_the_sweeps_cover_what_the_paper_states(config):
    sweep = config["simulations"]["scaling_displacement"]
    assert min(sweep["left"]) <= 0.1 and max(sweep["left"]) >= 0.9
    assert min(sweep["gamma"]) <= 1e-3 and max(sweep["gamma"]) >= 1.0
    assert len(sweep["left"]) * len(sweep["gamma"]) >= 60
    sweep = config["simulations"]["scaling_stress"]
    assert min(sweep["left"]) <= -2.0 and max(sweep["left"]) >= -0.1
    assert min(sweep["width"]) <= 0.5 and max(sweep["width"]) >= 16.0
    for name in ("damping_displacement", "damping_stress"):
        ratios = config["simulations"][name]["damping_ratio"]
        positive = [ratio for ratio in ratios if ratio > 0.0]
        assert 0.0 in ratios and len(ratios) >= 5 and max(positive) / min(positive) >= 100.0
