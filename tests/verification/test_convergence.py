"""Observed orders of convergence in the time step, relative to a much finer run of order 8."""

import math
from dataclasses import replace
from functools import cache
from itertools import product

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp

# Without damping the lattice oscillates at the scale of its spacing, and under a stress boundary
# the step can decide whether an event happens. These scenes have the same events for all steps.
BASES = {
    "displacement, undamped": ("displacement", 0.65, 0.0, sp.Prestress(0.5, 0.5)),
    "displacement, damped": ("displacement", 0.65, 0.02, sp.Prestress(0.5, 0.5)),
    "stress, damped": ("stress", 0.0, 0.02, sp.Prestress(-0.3, 0.2)),
}
# Gamma and the levels on the left and right, and then damping ratios with rate strengthening.
SPRUNG, UNSPRUNG = [(0.65, 0.5, 0.5), (0.1, 0.3, 0.8)], [(0.0, -0.5, 0.0), (0.0, 0.4, -0.2)]
RATES = [(0.0, 0.0), (0.1, 0.0), (1.0, 0.0), (0.0, 0.6), (0.1, 0.6)]
# Without leaf springs, slip would run away under friction that weakens with slip rate.
BALANCED = [*product(SPRUNG + UNSPRUNG, RATES), *product(SPRUNG, [(0.0, -0.3)])]
DAMPED = ("displacement, damped", "stress, damped")
STEPS, HALVED = (0.2, 0.1, 0.05), 2.0 ** np.arange(7)
ORDERS = [(order, name, tol.ORDER_ABOVE) for order in (4, 6) for name in ("release_time", "slip")]
ORDERS += [(order, "slip", math.inf) for order in (3, 5)]
orders = lambda errors: np.log2(np.array(errors[:-1]) / np.array(errors[1:]))
slope = lambda steps, errors: np.polyfit(np.log(steps), np.log(errors), 1)[0]


@cache
def run(base: str, **accuracy):
    """Return a run, at the blocks that are released by the end for every step."""
    boundary, gamma, beta, profile = BASES[base]
    how = {"resolved_blocks": 1} | accuracy
    scene = sp.Scene(boundary, profile, 10.0, 0.1, gamma=gamma, beta=beta, **how)
    return sp.simulate(scene).sel(x=slice(-8.0, 8.0))


def errors(base: str, quantity: str, steps=STEPS, mean=np.nanmax, **accuracy) -> list[float]:
    """Return the error of a field for each step, relative to the finest run."""
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
    """The error is a root mean square, since single release times jump by whole steps."""
    steps, (low, high) = 0.2 / 2.0 ** np.arange(9), tol.FIRST_ORDER
    mean = lambda error: np.sqrt(np.nanmean(error**2))
    deviations = errors(base, quantity, steps, mean, scheme="fixed_step")
    assert low < slope(steps, deviations) < high
    assert deviations[-1] < tol.FIXED_AGAINST_LOCALISED


# With damping, size and sign of the error depend on the position of events within the step, so the
# step is halved six times. The viscous loss is integrated to third order.
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
    """The work of the pre-stress is the sum of all other energies, at the step of the paper preset.

    These are kinetic energy, elastic energy, energy of the leaf springs, and the loss to damping
    and rate strengthening. Friction that weakens with slip rate adds energy.
    """
    (gamma, *levels), (ratio, alpha) = case
    boundary, dx = "displacement" if gamma else "stress", 0.02
    scene = sp.Scene(boundary, sp.Prestress(*levels), 12.0, dx, gamma, ratio * dx)
    scene = replace(scene, friction=sp.friction("linear_rate", alpha=alpha), **paper_accuracy)
    numbers = sp.simulate(scene).attrs
    assert numbers["energy_residual"] < tol.ENERGY
    stored = ("kinetic_energy", "elastic_energy", "leaf_spring_energy", "viscous_loss")
    total = sum(map(numbers.get, stored))
    assert numbers["work_of_prestress"] == pytest.approx(total, rel=tol.ENERGY)
    assert np.sign(numbers["viscous_loss"]) == np.sign(ratio + alpha)
    finer = replace(scene, max_step=0.1 * scene.max_step, order=8)
    assert sp.simulate(finer).attrs["energy_residual"] < tol.ENERGY_FINE
