"""The measured stability boundary on the derived one."""

import pytest
import tolerances as tol

from slippulse.model.stability import WEAK_ORDERS
from slippulse.studies.stability import boundary


@pytest.fixture(scope="module")
def rows(study):
    return study("stability")


def test_no_scheme_blows_up_below_its_bound(rows):
    assert rows[["measured_ratio", "measured_rupture_ratio"]].min(axis=None) >= 1.0 - tol.BOUNDARY_BELOW


def test_the_chain_blows_up_at_the_bound(rows):
    """Where damping makes the growth beyond it fast enough to be seen, at every order and under both schemes."""
    damped = rows[rows["damping_ratio"] >= 0.1]
    assert len(damped) == 28
    assert damped["measured_ratio"].max() <= 1.0 + tol.BOUNDARY_ABOVE
    undamped = rows[(rows["damping_ratio"] == 0.0) & (rows["order"] <= 4)]
    assert undamped["measured_ratio"].max() <= 1.0 + tol.BOUNDARY_ABOVE_UNDAMPED


def test_weak_orders_are_held_below_what_a_run_shows(rows):
    weak = rows[(rows["order"].isin(WEAK_ORDERS)) & (rows["damping_ratio"] == 0.0)]
    assert (weak["measured_ratio"] > 1.0).all()


@pytest.mark.parametrize(("between", "found"), [((0.2, 0.4), 0.4), ((3.0, 4.0), 3.0), ((0.5, 2.0), 1.0)])
def test_the_bisection_reports_the_end_beyond_which_it_does_not_look(between, found):
    assert boundary(lambda step: step <= 1.0, *between) == pytest.approx(found, abs=0.01)
