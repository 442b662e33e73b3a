"""What a run records on its way."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp

SCENE = sp.Scene("displacement", sp.Prestress(0.4, 0.6), 6.0, 0.05, gamma=0.65, beta=0.005, max_step=0.4)


def test_refusals():
    for times in ([0.0, 2.0, 1.0], [-0.1, 1.0], [0.0, np.nan]):
        with pytest.raises(ValueError, match=r"samples\.times"):
            sp.Samples(times, [0.0])
    for times, positions in (([[0.0, 1.0]], [0.0]), ([0.0, 1.0], 0.0)):
        with pytest.raises(ValueError, match="samples: times and positions"):
            sp.Samples(times, positions)
    with pytest.raises(ValueError, match=r"samples\.positions"):
        sp.Samples([0.0, 1.0], [np.inf])


@pytest.mark.parametrize("scheme", ["localised", "continuum"])
def test_samples_after_the_end_are_refused(scheme):
    scene = dataclasses.replace(SCENE, duration=1.0, scheme=scheme)
    samples = sp.Samples([0.5, 1.0, 3.5], [0.0])
    refusal = r"^samples\.times: 3\.5; allowed: up to the duration of the scene, 1$"
    with pytest.raises(ValueError, match=refusal):
        sp.simulate(scene, samples)
    with pytest.raises(ValueError, match=refusal):
        sp.run_sweep([scene], [samples])


def test_a_sample_is_the_state_of_a_run_that_ends_there():
    """At rest where no block is near."""
    times = np.array([0.0, 0.777, 2.5, 5.9])
    positions = np.array([-900.0, -3.0, -0.52, 0.0, 0.07, 2.0, 900.0])
    run = sp.simulate(SCENE, sp.Samples(times, positions))
    for s, time in enumerate(times[1:], start=1):
        end = sp.simulate(dataclasses.replace(SCENE, duration=float(time)))
        blocks = end.sel(x=positions, method="nearest")
        near = np.abs(blocks["x"].values - positions) < SCENE.dx
        for sampled, name in (("sample_slip", "slip"), ("sample_velocity", "slip_velocity")):
            expected = np.where(near, blocks[name].values, 0.0)
            assert run[sampled].values[s] == pytest.approx(expected, abs=tol.SAMPLE), (time, name)
    assert not run["sample_slip"].values[0].any()
    assert not run["sample_slip"].values[:, [0, -1]].any()


@pytest.mark.parametrize("scheme", ["localised", "fixed_step"])
def test_samples_do_not_change_the_run(scheme):
    scene = dataclasses.replace(SCENE, scheme=scheme)
    plain = sp.simulate(scene)
    sampled = sp.simulate(scene, sp.Samples(np.linspace(0.0, 6.0, 301), np.linspace(-5.0, 5.0, 51)))
    assert sampled[list(plain.data_vars)].equals(plain)


def test_mirrored_positions_have_mirrored_samples():
    scene = dataclasses.replace(SCENE, prestress=sp.Prestress(0.5, 0.5))
    positions = np.array([-1.0251, -0.075, -0.025, 0.025, 0.075, 1.0251])
    run = sp.simulate(scene, sp.Samples(np.linspace(0.0, 6.0, 13), positions))
    assert np.array_equal(run["sample_slip"].values, run["sample_slip"].values[:, ::-1])


def test_the_time_after_everything_stuck_is_the_final_state():
    scene = sp.Scene("stress", sp.Prestress(-2.0, -2.0), 20.0, 0.1, beta=0.01)
    run = sp.simulate(scene, sp.Samples([19.0, 20.0], [0.0]))
    assert run.attrs["stopped_because"] == "everything is stuck"
    assert (run["sample_slip"].values == float(run["slip"].sel(x=0.0))).all()
