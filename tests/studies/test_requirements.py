"""A scene costs what slides in it, and nothing else."""

from __future__ import annotations

import pytest
import tolerances as tol


@pytest.fixture(scope="module")
def rows(study):
    table = study("requirements")
    return lambda part: table[table["part"] == part].set_index("scene")


def test_only_sliding_blocks_are_updated(rows):
    work = rows("work")
    for scene in work.index:
        expected = 0.5 if scene.endswith("by symmetry") else 1.0
        assert work["value"][scene] == pytest.approx(expected, rel=tol.WORK)


def test_events_change_few_blocks_beside_those_that_slide(rows):
    """As many on one side as the order, for a release and a stick, against all sliding blocks twice meanwhile."""
    events = rows("events")["value"]
    assert (events > 0.0).all()
    assert events["crack, whole lattice"] < 0.05
    assert events["two pulses, by symmetry"] < 0.3


def test_the_whole_lattice_is_many_times_a_pulse(rows):
    assert rows("work")["blocks"]["two pulses, by symmetry"] > 15.0


def test_a_pulse_costs_linearly_in_time_and_quadratically_in_spacing(rows):
    exponents = rows("exponent")["value"]
    assert exponents["pulse, duration"] == pytest.approx(1.0, abs=tol.EXPONENT)
    assert exponents["pulse, spacing"] == pytest.approx(-2.0, abs=tol.EXPONENT)


def test_a_block_takes_few_bytes_and_an_order_eight_more(rows):
    memory = rows("memory").set_index("x")["value"]
    assert memory[4] < 200.0
    assert memory[8] - memory[4] == pytest.approx(4 * 8.0, rel=tol.WORK)
