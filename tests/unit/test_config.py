"""The shipped configuration: what its sweeps are."""

from __future__ import annotations

import pytest

from slippulse.configuration.expand import expand
from slippulse.configuration.resolve import resolve


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
