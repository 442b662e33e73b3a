"""Observed orders in the time step, each against a much finer run of the highest order."""

from __future__ import annotations

import math

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
STEPS = (0.2, 0.1, 0.05)


def run(base: str, **accuracy):
    boundary, gamma, beta, profile = BASES[base]
    scene = sp.Scene(boundary, profile, 10.0, 0.1, gamma=gamma, beta=beta, resolved_blocks=1, **accuracy)
    # Blocks that every run has released by the end.
    return sp.simulate(scene).sel(x=slice(-8.0, 8.0))


def orders(errors) -> np.ndarray:
    return np.log2(np.array(errors[:-1]) / np.array(errors[1:]))


@pytest.fixture(scope="module")
def finest():
    return {base: run(base, max_step=0.02, order=8) for base in BASES}


@pytest.mark.parametrize("quantity", ["release_time", "slip"])
@pytest.mark.parametrize("order", [4, 6])
@pytest.mark.parametrize("base", BASES)
def test_release_times_and_slip_converge_at_the_order_of_the_step(finest, base, order, quantity):
    errors = []
    for step in STEPS:
        difference = run(base, max_step=step, order=order)[quantity] - finest[base][quantity]
        errors.append(float(np.nanmax(np.abs(difference.values))))
    observed = orders(errors)[-1]
    assert order - tol.ORDER_BELOW < observed < order + tol.ORDER_ABOVE


@pytest.mark.parametrize("base", BASES)
def test_the_observed_order_of_three_and_five(finest, base):
    """The lower odd orders, by the last halving alone."""
    for order in (3, 5):
        errors = []
        for step in STEPS:
            difference = run(base, max_step=step, order=order)["slip"] - finest[base]["slip"]
            errors.append(float(np.nanmax(np.abs(difference.values))))
        assert orders(errors)[-1] > order - tol.ORDER_BELOW


def test_the_textbook_scheme_is_of_first_order_on_one_free_block():
    """Slip at a fixed time before the block sticks, against the closed form."""
    time, stiffness = 1.2, 2.65
    exact = (1.0 - math.cos(math.sqrt(stiffness) * time)) / stiffness
    errors = []
    for halving in range(5):
        scene = sp.Scene(
            "displacement", sp.Prestress(-3.0, -3.0), time, 1.0, gamma=0.65, scheme="fixed_step",
            max_step=0.1 / 2**halving, resolved_blocks=1,
        )  # fmt: skip
        errors.append(abs(float(sp.simulate(scene)["slip"].sel(x=0.0)) - exact))
    assert orders(errors) == pytest.approx(1.0, abs=tol.FIRST_ORDER_SMOOTH)


@pytest.mark.parametrize("base", ["displacement, damped", "stress, damped"])
def test_release_times_of_the_textbook_scheme_converge_at_first_order(finest, base):
    """Root mean square over the blocks, slope over eight halvings: single releases jump by whole steps."""
    steps = 0.2 / 2.0 ** np.arange(9)
    errors = []
    for step in steps:
        difference = (
            run(base, max_step=float(step), scheme="fixed_step")["release_time"]
            - finest[base]["release_time"]
        )
        errors.append(float(np.sqrt(np.nanmean(difference.values**2))))
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    low, high = tol.FIRST_ORDER
    assert low < slope < high
    assert errors[-1] < tol.FIXED_AGAINST_LOCALISED


def test_the_energy_balance_of_the_textbook_scheme_closes_at_first_order():
    residuals = [
        run("stress, damped", max_step=step, scheme="fixed_step").attrs["energy_residual"]
        for step in (0.1, 0.05, 0.025, 0.0125)
    ]
    assert orders(residuals) == pytest.approx(1.0, abs=tol.FIRST_ORDER_SMOOTH)


@pytest.mark.parametrize("order", [4, 6])
def test_the_energy_balance_closes_at_the_order_of_the_step_without_damping(order):
    residuals = [
        run("displacement, undamped", max_step=step, order=order).attrs["energy_residual"] for step in STEPS
    ]
    assert residuals == sorted(residuals, reverse=True)
    assert abs(orders(residuals)[-1] - order) < tol.ENERGY_ORDER


@pytest.mark.parametrize("base", ["displacement, damped", "stress, damped"])
@pytest.mark.parametrize(("order", "least", "most"), [(4, 3, 4), (8, 3, 3)])
def test_the_energy_balance_closes_at_third_order_with_damping(base, order, least, most):
    """The viscous loss is integrated to third order, beside the step's own error.

    Slope over six halvings: where in a step the events fall decides size and sign of that error.
    """
    steps = 0.8 / 2.0 ** np.arange(7)
    residuals = [run(base, max_step=float(step), order=order).attrs["energy_residual"] for step in steps]
    assert residuals == sorted(residuals, reverse=True)
    slope = np.polyfit(np.log(steps), np.log(residuals), 1)[0]
    assert least - tol.ENERGY_ORDER < slope < most + tol.ENERGY_ORDER


@pytest.mark.parametrize("ratio", [0.0, 0.1, 1.0])
@pytest.mark.parametrize(
    ("boundary", "gamma", "profile"),
    [
        ("displacement", 0.65, sp.Prestress(0.5, 0.5)),
        ("displacement", 0.1, sp.Prestress(0.3, 0.8)),
        ("stress", 0.0, sp.Prestress(-0.5, 0.0)),
        ("stress", 0.0, sp.Prestress(0.4, -0.2)),
    ],
)
def test_the_energy_balance_closes(paper_accuracy, boundary, gamma, profile, ratio):
    """Work of the pre-stress = kinetic + elastic + leaf springs + viscous loss, at the step of the paper preset."""
    dx = 0.02
    values = {"boundary": boundary, "prestress": profile, "duration": 12.0, "dx": dx, "gamma": gamma}
    run = sp.simulate(sp.Scene(**values, beta=ratio * dx, **paper_accuracy))
    assert run.attrs["energy_residual"] < tol.ENERGY
    stored = sum(
        run.attrs[name] for name in ("kinetic_energy", "elastic_energy", "leaf_spring_energy", "viscous_loss")
    )
    assert run.attrs["work_of_prestress"] == pytest.approx(stored, rel=tol.ENERGY)
    assert (run.attrs["viscous_loss"] > 0.0) == (ratio > 0.0)
    fine = sp.simulate(
        sp.Scene(**values, beta=ratio * dx, max_step=0.1 * paper_accuracy["max_step"], order=8)
    )
    assert fine.attrs["energy_residual"] < tol.ENERGY_FINE
