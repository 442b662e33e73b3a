"""Observed orders in the time step, each against a much finer run of the highest order."""

import math
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp

# Without damping the lattice rings at its own scale, and under a stress boundary an event may
# appear or vanish with the step. The order is measured where all steps have the same events.
BASES = {
    "displacement, undamped": ("displacement", 0.65, 0.0, sp.Prestress(0.5, 0.5)),
    "displacement, damped": ("displacement", 0.65, 0.02, sp.Prestress(0.5, 0.5)),
    "stress, damped": ("stress", 0.0, 0.02, sp.Prestress(-0.3, 0.2)),
}
# Gamma and the levels; the damping ratio and the rate strengthening.
SPRUNG, UNSPRUNG = [(0.65, 0.5, 0.5), (0.1, 0.3, 0.8)], [(0.0, -0.5, 0.0), (0.0, 0.4, -0.2)]
RATES = [(0.0, 0.0), (0.1, 0.0), (1.0, 0.0), (0.0, 0.6), (0.1, 0.6)]
# Weakening without leaf springs would let slip run away.
BALANCED = [*product(SPRUNG + UNSPRUNG, RATES), *product(SPRUNG, [(0.0, -0.3)])]
DAMPED = ("displacement, damped", "stress, damped")
STEPS, HALVED = (0.2, 0.1, 0.05), 2.0 ** np.arange(7)
ORDERS = [(order, name, tol.ORDER_ABOVE) for order in (4, 6) for name in ("release_time", "slip")]
ORDERS += [(order, "slip", math.inf) for order in (3, 5)]
orders = lambda errors: np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
slope = lambda steps, errors: np.polyfit(np.log(steps), np.log(errors), 1)[0]


@cache
def run(base: str, **accuracy):
    """The blocks that are released by the end in every case."""
    boundary, gamma, beta, profile = BASES[base]
    how = {"resolved_blocks": 1} | accuracy
    scene = sp.Scene(boundary, profile, 10.0, 0.1, gamma=gamma, beta=beta, **how)
    return sp.simulate(scene).sel(x=slice(-8.0, 8.0))


def errors(base: str, quantity: str, steps=STEPS, mean=np.nanmax, **accuracy) -> list[float]:
    finest = run(base, max_step=0.02, order=8)[quantity].values
    fields = [run(base, max_step=float(step), **accuracy)[quantity].values for step in steps]
    return [float(mean(np.abs(values - finest))) for values in fields]


@pytest.mark.parametrize(("order", "quantity", "above"), ORDERS)
@pytest.mark.parametrize("base", BASES)
def test_release_times_and_slip_converge_at_the_order_of_the_step(base, order, quantity, above):
    observed = orders(errors(base, quantity, order=order))[-1]
    assert order - tol.ORDER_BELOW < observed < order + above


@pytest.mark.parametrize("base", DAMPED)
@pytest.mark.parametrize("quantity", ["release_time", "slip"])
def test_the_textbook_scheme_converges_at_first_order(base, quantity):
    """Root mean square over the blocks, since single releases jump by entire steps."""
    steps, (low, high) = 0.2 / 2.0 ** np.arange(9), tol.FIRST_ORDER
    mean = lambda error: np.sqrt(np.nanmean(error**2))
    deviations = errors(base, quantity, steps, mean, scheme="fixed_step")
    assert low < slope(steps, deviations) < high
    assert deviations[-1] < tol.FIXED_AGAINST_LOCALISED


# The position of events in a step decides size and sign of the error of the step itself with
# damping, hence six halvings. The viscous loss is integrated to third order.
BALANCES = [("stress, damped", 0.1 / HALVED[:4], {"scheme": "fixed_step"}, (1, 1))]
BALANCES += [("displacement, undamped", STEPS[1:], {"order": n}, (n, n)) for n in (4, 6)]
BALANCES += [(base, 0.8 / HALVED, {"order": 4}, (3, 4)) for base in DAMPED]
BALANCES += [(base, 0.8 / HALVED, {"order": 8}, (3, 3)) for base in DAMPED]


@pytest.mark.parametrize(("base", "steps", "how", "between"), BALANCES)
def test_the_energy_balance_closes_at_the_order_of_the_step_or_of_the_loss(
    base, steps, how, between
):
    runs = [run(base, max_step=float(step), **how) for step in steps]
    values = [data.attrs["energy_residual"] for data in runs]
    assert values == sorted(values, reverse=True)
    error = tol.FIRST_ORDER_SMOOTH if "scheme" in how else tol.ENERGY_ORDER
    assert between[0] - error < slope(steps, values) < between[1] + error


@pytest.mark.parametrize("case", BALANCED)
def test_the_energy_balance_closes(paper_accuracy, case):
    """Work of the pre-stress = kinetic + elastic + leaf springs + loss, at the paper preset's step.

    The loss is to damping and rate strengthening. Friction that weakens with slip rate adds energy.
    """
    (gamma, *levels), (ratio, alpha) = case
    boundary, dx = "displacement" if gamma else "stress", 0.02
    scene = sp.Scene(boundary, sp.Prestress(*levels), 12.0, dx, gamma, ratio * dx)
    scene = replace(scene, friction=sp.friction("linear_rate", alpha=alpha), **paper_accuracy)
    numbers = sp.simulate(scene).attrs
    assert numbers["energy_residual"] < tol.ENERGY
    stored = ("kinetic_energy", "elastic_energy", "leaf_spring_energy", "viscous_loss")
    all_of_it = sum(map(numbers.get, stored))
    assert numbers["work_of_prestress"] == pytest.approx(all_of_it, rel=tol.ENERGY)
    assert np.sign(numbers["viscous_loss"]) == np.sign(ratio + alpha)
    finer = replace(scene, max_step=0.1 * scene.max_step, order=8)
    assert sp.simulate(finer).attrs["energy_residual"] < tol.ENERGY_FINE
