"""T_trans and L_trans of a measured run where the paper has none, or a reason for NaN."""

import math

import pytest

import slippulse as sp

# A first-order error halves with the spacing, apart from a second-order part.
FIRST_ORDER = 0.3


def measured(boundary: str, prestress: sp.Prestress, duration: float, **values) -> dict:
    scene = sp.Scene(boundary, prestress, duration, damping_ratio=0.1, **values)
    return sp.measure(sp.simulate(scene))


@pytest.mark.parametrize("levels", [(0.6, 0.45), (0.5, -0.5)])
def test_different_levels_have_the_transition_of_the_exact_rupture(levels):
    """The lattice converges to it at first order in its spacing."""
    profile, gamma = sp.Prestress(*levels), 5.0
    exact = sp.theory.Rupture(profile, gamma, 0.1, duration=4.0).transition
    errors = []
    for dx in (0.02, 0.01):
        numbers = measured("displacement", profile, 4.0, dx=dx, gamma=gamma)
        assert numbers["transition_reason"] == ""
        assert numbers["transition_time"] == numbers["first_stick_time"]
        found = numbers["transition_time"], numbers["transition_length"]
        errors.append([one / true - 1.0 for one, true in zip(found, exact, strict=True)])
    for coarse, fine in zip(*errors, strict=True):
        assert abs(coarse) < 0.02
        assert fine == pytest.approx(0.5 * coarse, rel=FIRST_ORDER)


def test_two_nucleations_have_no_length_and_a_reason():
    two = sp.Prestress(0.4, 0.4, bumps=((6.0, 0.65, 1.0),))
    numbers = measured("displacement", two, 6.0, dx=0.05, gamma=0.65)
    assert numbers["transition_time"] == numbers["first_stick_time"] > 0.0
    assert math.isnan(numbers["transition_length"])
    assert numbers["transition_reason"].startswith("several nucleations")


@pytest.mark.parametrize(
    ("reason", "boundary", "levels", "values"),
    [
        ("no block stuck before the end", "displacement", (0.5, 0.4), {"gamma": 0.65}),
        ("both levels are 0 or negative", "displacement", (-0.2, -0.2), {"gamma": 0.65}),
        ("the left front did not cover 95% of", "stress", (-0.5, 0.0), {}),
        ("under a stress boundary the paper defines it only for", "stress", (0.5, 0.5), {}),
    ],
)
def test_a_missing_transition_has_a_reason(reason, boundary, levels, values):
    numbers = measured(boundary, sp.Prestress(*levels), 1.0, dx=0.05, **values)
    assert math.isnan(numbers["transition_time"]) and math.isnan(numbers["transition_length"])
    assert numbers["transition_reason"].startswith(reason)


@pytest.mark.parametrize(
    "additions", [{"steps": ((3.0, -0.2),)}, {"bumps": ((4.0, -0.5, 3.0),)}], ids=str
)
def test_reason_names_steps_and_balance_position(additions):
    """The levels are those of the paper's transition, but it is not defined with these additions.

    With the bump, the integral of the pre-stress is negative, so that there is no balance position.
    """
    prestress = sp.Prestress(-0.05, 0.0, **additions)
    reason = measured("stress", prestress, 1.0, dx=0.05)["transition_reason"]
    assert reason.endswith("without steps, and with a balance position")
