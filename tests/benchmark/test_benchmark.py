"""The references of the benchmark are correct, and its command writes what it measures."""

import json
import math

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp
from tests.benchmark import __main__ as benchmark
from tests.benchmark import stencils

GAMMA, BETA = 0.3, 0.2
STEP = 0.4
# An eigenmode of a chain with fixed ends and dx = 1, and its stiffness.
SINE = np.sin(np.pi * 7 * np.arange(50) / 49)
STIFFNESS = 4.0 * math.sin(0.5 * np.pi * 7 / 49) ** 2


def test_the_stencil_is_a_taylor_step_of_order_four():
    derivatives = [1.0, 2.0]
    for _ in range(4):
        damping = BETA * STIFFNESS * derivatives[-1]
        derivatives.append(-(STIFFNESS + GAMMA) * derivatives[-2] - damping)
    w = np.zeros((6, SINE.size))
    w[0], w[1] = SINE, 2.0 * SINE
    stencils.taylor_steps(w, np.zeros(SINE.size), 1, STEP, 1.0, GAMMA, BETA)
    slip = sum(STEP**k / math.factorial(k) * derivatives[k] for k in range(6))
    velocity = sum(STEP**k / math.factorial(k) * derivatives[k + 1] for k in range(5))
    assert w[:2] == pytest.approx(np.outer([slip, velocity], SINE), abs=tol.STENCIL)


def test_plain_numpy_is_the_textbook_scheme():
    """It agrees with the compiled scheme on the same lattice: a crack turns into two pulses."""
    lattice = {"gamma": 0.65, "beta": 0.01, "scheme": "fixed_step", "max_step": 0.25}
    scene = sp.Scene("displacement", sp.Prestress(0.5, 0.5), 8.0, 0.1, **lattice)
    run = sp.simulate(scene)
    x = 0.1 * np.arange(-150, 151)
    slip = stencils.numpy_steps(scene.prestress(x), 320, 0.025, 0.1, 0.65, 0.01)
    assert np.interp(run["x"], x, slip) == pytest.approx(run["slip"].values, abs=tol.TEXTBOOK_SLIP)
    assert run.attrs["sticks"] > 0


def test_the_command_writes_ratios_and_the_machine(tmp_path, monkeypatch, capsys):
    """The scenes have about a hundredth of their usual size."""
    small = {"DURATION": 20.0, "DX": 0.05, "REPEATS": 1, "TURNS": 2, "POWERS": (3, 4)}
    small |= {"LENGTH": 60.0, "CRACK": (60.0, 90.0), "PULSE": (20.0, 30.0)}
    for name, value in small.items():
        monkeypatch.setattr(benchmark, name, value)
    benchmark.main(tmp_path)
    results = json.loads((tmp_path / "benchmark.json").read_text(encoding="utf-8"))
    assert set(results) == {"machine", "many_blocks", "pulse_of_200_blocks", "whole_scene"}
    assert results["machine"]["cores"] >= 1 and "numba" in results["machine"]["versions"]
    assert results["pulse_of_200_blocks"]["sliding_blocks"] == pytest.approx(200, rel=0.2)
    scene = results["whole_scene"]
    textbook = scene["textbook_steps"] * scene["textbook_seconds_per_step"]
    assert scene["times_faster_than_textbook"] == pytest.approx(textbook / scene["seconds"])
    assert (tmp_path / "benchmark.json").read_text(encoding="utf-8") in capsys.readouterr().out
