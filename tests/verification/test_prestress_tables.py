"""Runs with tables of pre-stress, compared with another solver, mirror images and shifted runs."""

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp

# Release and stick times, slip and ends of the fronts from a solver that shares no code with ours.
# It uses Runge-Kutta steps for all blocks and finds each event by bisection.
EXAMPLES = json.loads((Path(__file__).parents[1] / "reference/prestress_tables.json").read_text())
FIELDS = {"release": "release_time", "stick": "stick_time", "slip": "slip"}
HELD = {"boundary": "displacement", "duration": 8.0, "gamma": 0.65}
FREE = {"boundary": "stress", "duration": 8.0}


def scene_of(example, **settings):
    tau = example["tau"]
    spaced = example.get("start", 0.0) + example.get("spacing", 0.0) * np.arange(len(tau))
    profile = sp.Prestress.through(example.get("x", spaced), tau, width=example["width"])
    physics = {name: example[name] for name in ("boundary", "duration", "dx", "gamma", "beta")}
    return sp.Scene(prestress=profile, **physics, **settings)


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda example: example["name"])
@pytest.mark.parametrize("scheme", ["localised", "fixed_step"])
def test_a_table_gives_the_run_of_an_independent_solver(example, scheme):
    settings = {"order": 6} if scheme == "localised" else {"max_step": tol.TABLES_STEP}
    run = sp.simulate(scene_of(example, scheme=scheme, **settings))
    released = run["x"].values[np.isfinite(run["release_time"].values)]
    found = {"front_left": released[0], "front_right": released[-1]}
    for name in example["values"]:
        field, _, position = name.partition("@")
        if position:
            block = int(np.argmin(np.abs(run["x"].values - float(position))))
            found[name] = float(run[FIELDS[field]][block])
    allowed = tol.TABLES if scheme == "localised" else tol.TABLES_FIXED_STEP
    assert found == pytest.approx(example["values"], rel=allowed, abs=allowed)


def random_table(width):
    """Return a table with jumps that nucleates a rupture at x = 0, with or without a Gaussian."""
    rng = np.random.default_rng(11)
    x = np.sort(rng.uniform(-12.0, 12.0, 24))
    x[6], x[18] = x[7], x[17]
    tau = rng.uniform(-0.2, 0.9, 24)
    middle = np.searchsorted(x, 0.0)
    tent = [-0.8, 0.0, 0.7], [0.5, 1.0, 0.4]
    kept = np.abs(x) > 1.0
    left, right = slice(None, middle), slice(middle, None)
    columns = [
        np.concatenate([values[left][kept[left]], inner, values[right][kept[right]]])
        for values, inner in zip((x, tau), tent, strict=True)
    ]
    return sp.Prestress.through(*columns, width=width)


@pytest.mark.parametrize("physics", [HELD, FREE], ids=lambda physics: physics["boundary"])
@pytest.mark.parametrize("scheme", ["localised", "fixed_step"])
@pytest.mark.parametrize("width", [None, 1.0])
def test_a_mirrored_table_gives_the_mirrored_run(physics, scheme, width):
    profile = random_table(width)
    x, tau = np.array(profile.points[::-1]).T
    other = sp.Prestress.through(-x, tau, width=width)
    settings = {"dx": 0.05, "beta": 0.005, "scheme": scheme}
    one, mirrored = (
        sp.simulate(sp.Scene(prestress=p, **physics, **settings)) for p in (profile, other)
    )
    for name in ("prestress", *FIELDS.values()):
        reversed_values = mirrored[name].values[::-1]
        if scheme == "localised":
            assert np.array_equal(reversed_values, one[name].values, equal_nan=True), name
        # The textbook scheme adds the neighbours of a block from left to right.
        assert reversed_values == pytest.approx(one[name].values, abs=tol.MIRROR, nan_ok=True)
    assert np.array_equal(-mirrored["x"].values[::-1], one["x"].values)


@pytest.mark.parametrize("physics", [HELD, FREE], ids=lambda physics: physics["boundary"])
def test_a_shifted_table_gives_the_shifted_run(physics):
    profile, blocks, dx = random_table(None), 137, 0.05
    x, tau = np.array(profile.points).T
    other = sp.Prestress.through(x + blocks * dx, tau)
    one, shifted = (
        sp.simulate(sp.Scene(prestress=p, **physics, dx=dx, beta=0.005)) for p in (profile, other)
    )
    first, moved = (np.isfinite(run["release_time"].values) for run in (one, shifted))
    assert shifted["x"].values[moved] == pytest.approx(one["x"].values[first] + blocks * dx)
    for name in FIELDS.values():
        before, after = one[name].values[first], shifted[name].values[moved]
        assert after == pytest.approx(before, abs=tol.MIRROR, nan_ok=True)


def test_points_on_the_lines_of_a_table_change_no_run_beyond_rounding():
    profile = random_table(1.0)
    extra = np.linspace(-11.0, 11.0, 57)
    x, tau = np.array(profile.points).T
    positions = np.append(x, extra)
    order = np.argsort(positions, kind="stable")
    finer = sp.Prestress.through(
        positions[order], np.append(tau, profile.level(extra))[order], width=1.0
    )
    runs = [sp.simulate(sp.Scene(prestress=p, **HELD, dx=0.05)) for p in (profile, finer)]
    for name in FIELDS.values():
        values = [run[name].values for run in runs]
        assert values[1] == pytest.approx(values[0], abs=tol.MIRROR, nan_ok=True)


@pytest.mark.parametrize("physics", [HELD, FREE], ids=lambda physics: physics["boundary"])
def test_a_sampled_gaussian_converges_to_its_run_at_second_order(physics):
    gaussian = sp.Prestress(0.3, 0.3)
    scene = sp.Scene(prestress=gaussian, **physics, dx=0.02, beta=0.002)
    exact, errors = sp.simulate(scene), []
    for spacing in (0.4, 0.2, 0.1):
        x = spacing * np.arange(-round(8.0 / spacing), round(8.0 / spacing) + 1)
        table = sp.Prestress.through(x, gaussian(x))
        run = sp.simulate(dataclasses.replace(scene, prestress=table))
        slips = []
        for one in (run, exact):
            # Both lattices end a little beyond their fronts, so both contain this part.
            slips.append(one["slip"].values[np.abs(one["x"].values) < 7.0])
        errors.append(float(np.max(np.abs(slips[0] - slips[1]))))
    orders = [math.log2(errors[i] / errors[i + 1]) for i in (0, 1)]
    assert orders == pytest.approx([2.0, 2.0], abs=tol.TABLE_ORDER)
