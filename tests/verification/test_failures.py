"""Runs that are not the model's: stopped with a reason, or flagged."""

from __future__ import annotations

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp
from slippulse.model.scene import LATTICE_SCHEMES
from slippulse.model.stability import largest_step
from slippulse.solver.lattice import Lattice
from slippulse.solver.run import run_scene

PUBLISHED = {
    "boundary": "displacement",
    "gamma": 0.55,
    "beta": 1e-3,
    "dx": 0.01,
    "duration": 10.8,
    "prestress": sp.Prestress(0.25, 0.25),
}


class TooLong(Exception):
    """A run that does not come to an end."""


def at_most(calls: int):
    """Progress that gives up: a run that repeats one instant for ever would not return otherwise."""
    seen = []

    def progress(share: float) -> None:
        seen.append(share)
        if len(seen) > calls:
            raise TooLong(f"after {calls} calls at {share:.3g} of the duration")

    return progress


@pytest.mark.parametrize("release", ["total", "elastic"])
@pytest.mark.parametrize("scheme", LATTICE_SCHEMES)
def test_the_printed_sign_of_the_damping_ends_a_run(scheme, release):
    """The published scene with -beta: modes grow at up to 2 beta/dx^2, 20 per unit of time."""
    scene = sp.Scene(**PUBLISHED, scheme=scheme, release=release)
    with pytest.raises(sp.UnstableRun, match=r"t = \d"):
        run_scene(scene, progress=at_most(40), damping_sign=-1)
    assert run_scene(scene).numbers["end_time"] == scene.duration


@pytest.mark.parametrize("row", [0, 1])
@pytest.mark.parametrize("value", [np.nan, np.inf])
@pytest.mark.parametrize("place", [0.2, 0.5, 0.9])
@pytest.mark.parametrize("scheme", LATTICE_SCHEMES)
def test_a_value_that_is_not_finite_is_noticed(scheme, place, value, row):
    """Put into the slip or the velocity of a sliding block."""
    scene = sp.Scene("displacement", sp.Prestress(0.5, 0.4), 4.0, 0.05, gamma=0.65, beta=0.005, scheme=scheme)
    lattice = Lattice(scene, None, scene.beta)
    lattice.run(None)
    object.__setattr__(scene, "duration", 8.0)
    moving = np.flatnonzero(lattice.motion.w[1] > 0.0)
    block = moving[int(place * moving.size)]
    lattice.motion.w[row, block] = value
    if row == 0 and scheme == "localised":
        lattice.motion.strain[block] = value
    with pytest.raises(sp.UnstableRun, match="not finite"):
        lattice.run(at_most(20))


UNRESOLVED = {"boundary": "displacement", "gamma": 0.65, "prestress": sp.Prestress(0.3, 0.3), "dx": 0.4}


def test_a_pulse_of_few_blocks_is_flagged():
    run = sp.simulate(sp.Scene(**UNRESOLVED, duration=20.0))
    assert run.attrs["run_flags"] == "unresolved_pulse"
    assert 0 < run.attrs["pulse_blocks"] < 8
    assert sp.simulate(sp.Scene(**UNRESOLVED | {"dx": 0.05}, duration=20.0)).attrs["run_flags"] == ""
    assert sp.simulate(sp.Scene(**UNRESOLVED, duration=20.0, resolved_blocks=1)).attrs["run_flags"] == ""


def test_under_a_stress_boundary_the_gaussian_must_be_resolved():
    values = {"boundary": "stress", "prestress": sp.Prestress(-0.5, 0.0), "duration": 4.0}
    assert sp.simulate(sp.Scene(**values, dx=0.2)).attrs["run_flags"] == "unresolved_pulse"
    assert sp.simulate(sp.Scene(**values, dx=0.125)).attrs["run_flags"] == ""


@pytest.mark.parametrize(("ratio", "flagged"), [(0.0, True), (0.2, True), (0.3, False), (5.0, False)])
def test_a_stress_beyond_the_threshold_of_reverse_sliding_is_flagged(ratio, flagged):
    """The level -1.5 is there from the start: -(1 + 2 ratio) is above it for ratios below 0.25."""
    scene = sp.Scene("stress", sp.Prestress(-1.5, 0.3), 3.0, 0.05, beta=0.01, friction_ratio=ratio)
    run = sp.simulate(scene)
    assert (run.attrs["run_flags"] == "reverse_sliding") is flagged
    assert run.attrs["friction_ratio_needed"] >= 0.25


@pytest.mark.parametrize(("times_the_bound", "stops"), [(tol.ABOVE_BOUND, False), (1.5, True)])
def test_a_step_too_long_for_the_damping_is_flagged_or_stops(times_the_bound, stops):
    scene = sp.Scene("stress", sp.Prestress(-0.5, -0.1), 20.0, 0.05, beta=0.05, max_step=0.5)
    object.__setattr__(scene, "max_step", times_the_bound * largest_step("localised", 4, 1.0, 0.0))
    if stops:
        with pytest.raises(sp.UnstableRun, match=r"unstable at t = .*max_step"):
            sp.simulate(scene)
    else:
        assert "energy" in sp.simulate(scene).attrs["run_flags"]


def test_strict_raises_where_a_flag_would_be_set():
    with pytest.raises(sp.UnresolvedRun, match=r"unresolved_pulse .*needed 8"):
        sp.simulate(sp.Scene(**UNRESOLVED, duration=20.0), strict=True)
    sp.simulate(sp.Scene(**UNRESOLVED | {"dx": 0.05}, duration=20.0), strict=True)


def test_a_run_can_be_interrupted():
    def stop(_share: float) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        sp.simulate(sp.Scene(**PUBLISHED), progress=stop)


DYING = {"boundary": "displacement", "gamma": 0.65, "beta": 0.01, "dx": 0.1, "duration": 60.0}


def test_a_pulse_that_dies_where_the_prestress_would_drive_it_on_is_flagged():
    """tau_0 = 0.01: the steady pulse goes on for ever, the lattice of dx = 0.1 is too coarse to carry it."""
    run = sp.simulate(sp.Scene(**DYING, prestress=sp.Prestress(0.01, 0.01)))
    assert run.attrs["stopped_because"] == "everything is stuck"
    assert run.attrs["run_flags"] == "died_out"


def test_a_pulse_that_dies_on_one_side_is_flagged():
    run = sp.simulate(sp.Scene(**DYING, prestress=sp.Prestress(0.01, 0.5)))
    assert run.attrs["stopped_because"] == "duration reached"
    assert "died_out" in run.attrs["run_flags"].split(",")


@pytest.mark.parametrize("level", [-0.5, 0.0])
def test_an_arrest_without_prestress_to_drive_it_is_not_flagged(level):
    run = sp.simulate(sp.Scene(**DYING | {"dx": 0.02}, prestress=sp.Prestress(level, level)))
    assert run.attrs["stopped_because"] == "everything is stuck"
    assert run.attrs["run_flags"] == ""


def test_a_peak_that_falls_to_zero_within_a_few_blocks_is_flagged():
    """Level -100: the pre-stress is positive over a seventh of the Gaussian's width on each side."""
    values = {
        "boundary": "stress",
        "prestress": sp.Prestress(-100.0, 0.0),
        "duration": 4.0,
        "friction_ratio": 60.0,
    }
    coarse = sp.simulate(sp.Scene(**values, dx=0.1, beta=0.01))
    assert coarse.attrs["run_flags"] == "unresolved_pulse" and coarse.attrs["pulse_blocks"] == 1
    assert sp.simulate(sp.Scene(**values, dx=0.005, beta=5e-4)).attrs["run_flags"] == ""
