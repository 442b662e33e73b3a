"""Only sliding blocks cost work, a block takes few bytes, and the lattice grows as it needs to."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp
from slippulse.solver import lattice as lattices
from slippulse.solver.fixed_step import LATTICES
from slippulse.solver.lattice import INITIAL_BLOCKS, Lattice
from slippulse.solver.solution import solve_on_lattice

STEP = {"beta": 0.1 * 0.04, "max_step": 0.5}
PULSE = sp.Scene("displacement", sp.Prestress(0.5, 0.5), 50.0, 0.04, gamma=0.65, **STEP)
CRACK = sp.Scene("stress", sp.Prestress(0.5, 0.5), 50.0, 0.04, half_lattice=False, **STEP)


class Work(NamedTuple):
    """A scene and the work that it is expected to take."""

    scene: sp.Scene
    # Block updates per step, divided by the mean number of sliding blocks: 1 if no other blocks are
    # touched, 1/2 if only half of a symmetric scene is solved.
    updates_per_sliding_block: float
    max_event_updates: float  # blocks changed by events, divided by the block updates
    min_released_blocks: float  # divided by the mean number of sliding blocks


ONE_PULSE = replace(CRACK, prestress=sp.Prestress(-0.5, 0.0))
WORK = {
    "two pulses, by symmetry": Work(PULSE, 0.5, 0.3, 15.0),
    "two pulses, whole lattice": Work(replace(PULSE, half_lattice=False), 1.0, 0.3, 15.0),
    "crack, whole lattice": Work(CRACK, 1.0, 0.05, 1.0),
    "one pulse, whole lattice": Work(ONE_PULSE, 1.0, 0.05, 1.0),
}


@pytest.mark.parametrize("name", WORK)
def test_only_sliding_blocks_are_updated_and_events_change_few(name):
    """An event changes as many blocks on each side as the order; a step changes all that slide."""
    work = WORK[name]
    run = solve_on_lattice(work.scene)
    released, end = np.isfinite(run.release_time), run.numbers["end_time"]
    stopped = np.where(np.isfinite(run.stick_time), run.stick_time, end)
    sliding = float(np.sum(stopped[released] - run.release_time[released])) / end
    updates = run.numbers["block_updates"]
    updates_per_block = updates / run.numbers["steps"] / sliding
    assert updates_per_block == pytest.approx(work.updates_per_sliding_block, rel=tol.WORK)
    assert 0.0 < run.numbers["event_updates"] < work.max_event_updates * updates
    assert released.sum() > work.min_released_blocks * sliding


@pytest.mark.parametrize(
    ("changes", "exponent"),
    [
        ([{"duration": 50.0 * factor} for factor in (1.0, 2.0, 4.0)], 1.0),
        ([{"dx": dx, "beta": 0.1 * dx} for dx in (0.04, 0.02, 0.01)], -2.0),
    ],
)
def test_a_pulse_costs_linearly_in_time_and_quadratically_in_spacing(changes, exponent):
    solutions = [solve_on_lattice(replace(PULSE, **change)) for change in changes]
    work = [solution.numbers["block_updates"] for solution in solutions]
    values = [next(iter(change.values())) for change in changes]
    slope = np.polyfit(np.log(values), np.log(work), 1)[0]
    assert slope == pytest.approx(exponent, abs=tol.EXPONENT)


def test_a_block_takes_few_bytes_and_each_order_takes_eight_more():
    def bytes_per_block(order: int) -> float:
        lattice = Lattice(replace(PULSE, order=order), None, PULSE.beta)
        lattice.advance_to_end(None)
        rows = (*lattice.motion, *lattice.history)
        return sum(row.nbytes for row in rows) / lattice.size

    assert bytes_per_block(4) < 200.0
    assert bytes_per_block(8) - bytes_per_block(4) == pytest.approx(4 * 8.0, rel=tol.WORK)


@pytest.mark.parametrize("right", [0.5, 0.4], ids=["half lattice", "whole lattice"])
def test_rows_begin_at_different_places_of_their_pages(right):
    """Any two rows begin at least three cache lines apart, modulo a page of 4096 bytes."""
    scene = sp.Scene("displacement", sp.Prestress(0.5, right), 320.0, 0.1, gamma=0.5, order=8)
    lattice = Lattice(scene, None, 0.0)
    lattice.advance_to_end(None)
    rows = (*lattice.motion.derivatives, *lattice.motion[1:])
    positions = np.sort([row.ctypes.data % 4096 for row in rows])
    assert np.diff(positions, append=positions[0] + 4096).min() >= 3 * 64
    assert lattice.size > 4 * INITIAL_BLOCKS


@pytest.mark.parametrize("scheme", LATTICES)
@pytest.mark.parametrize("right", [0.4, 0.6], ids=["half lattice", "whole lattice"])
def test_results_do_not_depend_on_the_initial_size_or_the_length_of_a_call(
    monkeypatch, right, scheme
):
    profile, fractions = sp.Prestress(0.4, right, peak=1.05, steps=((4.0, 0.5), (-4.0, 0.5))), []
    scene = replace(PULSE, prestress=profile, duration=8.0, max_step=0.3, scheme=scheme)
    plain = sp.simulate(scene)
    for name, value in {
        "INITIAL_BLOCKS": 16,
        "PAGE_BLOCKS": 8,
        "PAGE_OFFSET": 3,
        "MAX_CALL_STEPS": 7,
    }.items():
        monkeypatch.setattr(lattices, name, value)
    grown = sp.simulate(scene, progress=fractions.append)
    assert grown.equals(plain) and plain.attrs["releases"] > 100
    assert grown.attrs["block_updates"] == plain.attrs["block_updates"]
    assert len(fractions) > 10
    assert fractions == sorted(fractions) and fractions[0] > 0.0 and fractions[-1] <= 1.0
