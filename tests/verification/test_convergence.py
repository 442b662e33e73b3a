"""Observed orders in the time step, each against a much finer run of the highest order."""

import math
from functools import cache

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp

# Without damping the lattice rings at its own scale and an event may appear or vanish with the step under a stress
# boundary: order is measured where the events are the same at every step.
BASES = {
    "displacement, undamped": ("displacement", 0.65, 0.0, sp.Prestress(0.5, 0.5)),
    "displacement, damped": ("displacement", 0.65, 0.02, sp.Prestress(0.5, 0.5)),
    "stress, damped": ("stress", 0.0, 0.02, sp.Prestress(-0.3, 0.2)),
}
DAMPED = ("displacement, damped", "stress, damped")
STEPS = (0.2, 0.1, 0.05)


@cache
def run(base: str, **accuracy):
    """Blocks that every run has released by the end."""
    boundary, gamma, beta, profile = BASES[base]
    scene = sp.Scene(
        boundary, profile, 10.0, 0.1, gamma=gamma, beta=beta, resolved_blocks=1, **accuracy
    )
    return sp.simulate(scene).sel(x=slice(-8.0, 8.0))


def errors(base: str, quantity: str, steps=STEPS, mean=np.nanmax, **accuracy) -> list[float]:
    finest = run(base, max_step=0.02, order=8)[quantity].values
    found = (run(base, max_step=float(step), **accuracy)[quantity].values for step in steps)
    return [float(mean(np.abs(values - finest))) for values in found]


def residuals(base: str, steps=STEPS, **accuracy) -> list[float]:
    found = [run(base, max_step=float(step), **accuracy).attrs["energy_residual"] for step in steps]
    assert found == sorted(found, reverse=True)
    return found


def orders(errors) -> np.ndarray:
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


def slope(steps, errors) -> float:
    return np.polyfit(np.log(steps), np.log(errors), 1)[0]


@pytest.mark.parametrize(
    ("order", "quantity", "above"),
    [
        *((order, name, tol.ORDER_ABOVE) for order in (4, 6) for name in ("release_time", "slip")),
        *((order, "slip", math.inf) for order in (3, 5)),
    ],
)
@pytest.mark.parametrize("base", BASES)
def test_release_times_and_slip_converge_at_the_order_of_the_step(base, order, quantity, above):
    observed = orders(errors(base, quantity, order=order))[-1]
    assert order - tol.ORDER_BELOW < observed < order + above


def test_the_textbook_scheme_is_of_first_order_on_one_free_block_and_in_its_energy_balance():
    """Slip at a fixed time before the block sticks, against the closed form."""
    time, stiffness = 1.2, 2.65
    exact = (1.0 - math.cos(math.sqrt(stiffness) * time)) / stiffness
    off = []
    for halving in range(5):
        accuracy = {"scheme": "fixed_step", "max_step": 0.1 / 2**halving, "resolved_blocks": 1}
        scene = sp.Scene(
            "displacement", sp.Prestress(-3.0, -3.0), time, 1.0, gamma=0.65, **accuracy
        )
        off.append(abs(float(sp.simulate(scene)["slip"].sel(x=0.0)) - exact))
    energy = residuals("stress, damped", (0.1, 0.05, 0.025, 0.0125), scheme="fixed_step")
    for found in (off, energy):
        assert orders(found) == pytest.approx(1.0, abs=tol.FIRST_ORDER_SMOOTH)


@pytest.mark.parametrize("base", DAMPED)
def test_release_times_of_the_textbook_scheme_converge_at_first_order(base):
    """Root mean square over the blocks, slope over eight halvings: single releases jump by whole steps."""
    steps, (low, high) = 0.2 / 2.0 ** np.arange(9), tol.FIRST_ORDER
    off = errors(
        base, "release_time", steps, lambda e: np.sqrt(np.nanmean(e**2)), scheme="fixed_step"
    )
    assert low < slope(steps, off) < high
    assert off[-1] < tol.FIXED_AGAINST_LOCALISED


@pytest.mark.parametrize("order", [4, 6])
def test_the_energy_balance_closes_at_the_order_of_the_step_without_damping(order):
    assert (
        abs(orders(residuals("displacement, undamped", order=order))[-1] - order) < tol.ENERGY_ORDER
    )


@pytest.mark.parametrize("base", DAMPED)
@pytest.mark.parametrize(("order", "least", "most"), [(4, 3, 4), (8, 3, 3)])
def test_the_energy_balance_closes_at_third_order_with_damping(base, order, least, most):
    """The viscous loss is integrated to third order, beside the step's own error.

    Slope over six halvings: where in a step the events fall decides size and sign of that error.
    """
    steps = 0.8 / 2.0 ** np.arange(7)
    observed = slope(steps, residuals(base, steps, order=order))
    assert least - tol.ENERGY_ORDER < observed < most + tol.ENERGY_ORDER


@pytest.mark.parametrize(
    "rates", [(0.0, 0.0), (0.1, 0.0), (1.0, 0.0), (0.0, 0.6), (0.1, 0.6), (0.0, -0.3)]
)
@pytest.mark.parametrize(
    "case", [(0.65, 0.5, 0.5), (0.1, 0.3, 0.8), (0.0, -0.5, 0.0), (0.0, 0.4, -0.2)]
)
def test_the_energy_balance_closes(paper_accuracy, case, rates):
    """Work of the pre-stress = kinetic + elastic + leaf springs + loss, at the step of the paper preset.

    The loss is to damping and to rate strengthening; friction that weakens with slip rate puts energy in.
    """
    (gamma, *levels), (ratio, alpha) = case, rates
    if alpha**2 >= 4.0 * gamma and alpha < 0.0:
        pytest.skip("slip runs away")
    boundary, dx = "displacement" if gamma else "stress", 0.02
    of = (boundary, sp.Prestress(*levels), 12.0, dx, gamma, ratio * dx)
    numbers = sp.simulate(sp.Scene(*of, rate_strengthening=alpha, **paper_accuracy)).attrs
    assert numbers["energy_residual"] < tol.ENERGY
    stored = ("kinetic_energy", "elastic_energy", "leaf_spring_energy", "viscous_loss")
    assert numbers["work_of_prestress"] == pytest.approx(
        sum(map(numbers.get, stored)), rel=tol.ENERGY
    )
    assert np.sign(numbers["viscous_loss"]) == np.sign(ratio + alpha)
    finer = {"max_step": 0.1 * paper_accuracy["max_step"], "order": 8, "rate_strengthening": alpha}
    assert sp.simulate(sp.Scene(*of, **finer)).attrs["energy_residual"] < tol.ENERGY_FINE
