"""Other laws of friction on lattices: energy balance, healing, and steady ruptures by theory."""

import numpy as np
import pytest

import slippulse as sp
from slippulse import theory
from slippulse.model.friction import LAWS

GAMMA, BETA = 2.0 / 3.0, 0.05
SPACINGS = (0.08, 0.04, 0.02)
# Work against friction is summed to second order in the step.
MAX_ENERGY_RESIDUAL = 1e-5
EXAMPLES = {
    "coulomb": {},
    "linear_rate": {"alpha": 0.4},
    "bounded_rate": {"limit": 0.3, "v_0": 1.0},
    "rate_weakening": {"slope": 1.5, "limit": 0.3},
    "slip_weakening": {"d_c": 0.1, "nucleation": 2.0},
    "exponential_weakening": {"d_c": 0.05, "nucleation": 2.0},
}


def run(law, dx, level=0.5, duration=40.0, beta=BETA, step=0.1, **values):
    values = {"scheme": "fixed_step", "max_step": step, "beta": beta} | values
    layer = "displacement", sp.Prestress(level, level)
    return sp.simulate(sp.Scene(*layer, duration, dx, GAMMA, friction=law, **values))


@pytest.mark.parametrize("law", [law.law for law in LAWS])
@pytest.mark.parametrize("half", [True, False])
def test_the_energy_balance_closes_with_the_work_against_friction(law, half):
    friction = sp.friction(law, **EXAMPLES[law])
    scene = friction, 0.05, 0.7, 15.0
    coarse, fine = (run(*scene, step=step, half_lattice=half).attrs for step in (0.04, 0.02))
    if law in ("coulomb", "linear_rate"):
        assert fine["friction_loss"] == 0.0
        return
    assert fine["energy_residual"] < MAX_ENERGY_RESIDUAL
    assert fine["energy_residual"] < 0.4 * coarse["energy_residual"]
    assert np.sign(fine["friction_loss"]) == (-1.0 if law == "rate_weakening" else 1.0)


@pytest.mark.parametrize("law", ["slip_weakening", "exponential_weakening"])
def test_the_work_against_friction_is_the_fracture_energy_of_the_path(law):
    """It is d_c per length for exponential weakening and slip > 50 d_c, and d_c/2 for linear."""
    data = run(sp.friction(law, d_c=0.02, nucleation=2.0), 0.02, 0.8, 12.0, step=0.05)
    done = (np.abs(data["x"].values) >= 2.0) & (data["slip"].values > 0.0)
    per_length = 0.02 if law == "exponential_weakening" else 0.01
    # Blocks at the fronts have not weakened completely.
    assert data.attrs["friction_loss"] == pytest.approx(per_length * 0.02 * done.sum(), rel=0.03)


@pytest.mark.parametrize(("scheme", "least"), [("fixed_step", 1.0), ("localised", 3.0)])
@pytest.mark.parametrize(
    ("level", "d_c", "sticks"), [(0.8, 0.1, True), (0.5, 0.2, True), (0.5, 0.3, False)]
)
def test_lattices_tend_to_the_rupture_of_linear_weakening(level, d_c, sticks, scheme, least):
    """With events, the error falls by a factor of at least 3 each time the spacing is halved."""
    exact = theory.weakening_pulse(level, GAMMA, BETA, d_c)
    law = sp.friction("slip_weakening", d_c=d_c, nucleation=2.0)
    runs = [run(law, dx, level, scheme=scheme) for dx in SPACINGS]
    measured = [sp.measure(data) for data in runs]
    assert (
        scheme == "fixed_step"
        or max(data.attrs["energy_residual"] for data in runs) < MAX_ENERGY_RESIDUAL
    )
    assert exact.sticks == sticks
    expected = {"front_speed_right": exact.speed} | ({"pulse_slip": exact.slip} if sticks else {})
    for name, value in expected.items():
        errors = np.abs([numbers[name] / value - 1.0 for numbers in measured])
        assert errors[2] < 5e-4 and (errors[:2] > least * errors[1:]).all()
    assert not sticks or measured[2]["pulse_width"] == pytest.approx(exact.width, rel=0.02)


RATE_WEAKENING = sp.friction("rate_weakening", **EXAMPLES["rate_weakening"])
SLIP_WEAKENING = sp.friction("slip_weakening", **EXAMPLES["slip_weakening"])
BOUNDED_RATE = sp.friction("bounded_rate", **EXAMPLES["bounded_rate"])


@pytest.mark.parametrize("ratio", [0.0, 0.1])
def test_bounded_weakening_with_slip_rate_by_events_tends_to_its_steady_pulse(ratio):
    exact = theory.rate_pulse(0.5, GAMMA, ratio, RATE_WEAKENING)
    runs = [run(RATE_WEAKENING, dx, beta=ratio * dx, scheme="localised") for dx in SPACINGS]
    assert max(data.attrs["energy_residual"] for data in runs) < MAX_ENERGY_RESIDUAL
    measured = [sp.measure(data) for data in runs]
    for name, value in (("pulse_slip", exact.slip), ("front_speed_right", exact.speed)):
        errors = np.abs([numbers[name] / value - 1.0 for numbers in measured])
        assert errors[2] < 0.01 and (errors[:2] > 1.7 * errors[1:]).all()


def test_bounded_strengthening_tends_to_its_steady_pulse():
    exact = theory.rate_pulse(0.5, GAMMA, 0.1, BOUNDED_RATE)
    how = {"duration": 25.0, "step": 0.0213}
    measured = [sp.measure(run(BOUNDED_RATE, dx, beta=0.1 * dx, **how)) for dx in SPACINGS]
    errors = [abs(numbers["pulse_slip"] / exact.slip - 1.0) for numbers in measured]
    assert errors[0] >= errors[1] >= errors[2] and errors[2] < 5e-3
    # Fronts of this scheme lock to a whole number of steps per block.
    expected = {"front_speed_right": exact.speed, "pulse_peak_velocity": exact.peak_velocity}
    assert {name: measured[2][name] for name in expected} == pytest.approx(expected, rel=0.01)
    assert measured[2]["pulse_width"] == pytest.approx(exact.width, rel=0.02)


@pytest.mark.parametrize("order", [4, 6, 8])
def test_a_step_keeps_its_order_if_friction_has_a_kink_within_it(order):
    scene = {"dx": 0.1, "beta": 0.01, "duration": 8.0, "scheme": "localised"}
    fine = run(RATE_WEAKENING, **scene, order=8, step=0.02)["slip"]
    coarse = [run(RATE_WEAKENING, **scene, order=order, step=step)["slip"] for step in (0.4, 0.2)]
    errors = [float(np.abs(slip - fine).max()) for slip in coarse]
    assert errors[1] < errors[0] / 2.0 ** (order - 1)


@pytest.mark.parametrize(
    "profile",
    [
        sp.Prestress(0.5, 0.5),
        sp.Prestress(0.5, -0.5),
        sp.Prestress(0.5, 0.5, steps=((5.0, -0.3), (-6.0, 0.2))),
        sp.Prestress(0.5, 0.5, bumps=((9.0, 0.5, 1.0),)),
    ],
)
def test_energy_balances_with_kinks_of_friction_also_where_pulses_die_or_meet(profile):
    def solve(**values):
        how = {"scheme": "localised", "friction": RATE_WEAKENING, "beta": 0.005} | values
        return sp.simulate(sp.Scene("displacement", profile, 12.0, 0.05, GAMMA, **how))

    data, fine = solve(max_step=0.1), solve(max_step=0.05)
    assert data.attrs["energy_residual"] < 1e-7 and fine.attrs["energy_residual"] < 1e-7
    assert (data.attrs["re_releases"] > 0) == bool(profile.bumps)
    assert float(np.abs(data["slip"] - fine["slip"]).max()) < 1e-5
    textbook = solve(scheme="fixed_step", max_step=0.01)
    assert float(np.abs(data["slip"] - textbook["slip"]).max()) < 0.01
    assert data.attrs["friction_loss"] == pytest.approx(textbook.attrs["friction_loss"], rel=2e-3)


def test_bounded_weakening_that_never_reaches_its_kink_is_linear():
    linear = run(sp.friction("linear_rate", alpha=-0.4), 0.05, scheme="localised", duration=12.0)
    law = sp.friction("rate_weakening", slope=0.4, limit=1e3)
    data = run(law, 0.05, scheme="localised", duration=12.0)
    np.testing.assert_allclose(data["slip"], linear["slip"], rtol=1e-10, atol=1e-12)
    loss = linear.attrs["viscous_loss"]
    assert data.attrs["viscous_loss"] + data.attrs["friction_loss"] == pytest.approx(loss, rel=1e-9)
    none = run(sp.friction("rate_weakening", slope=0.0, limit=1.0), 0.05, scheme="localised")
    assert none["slip"].equals(run(sp.friction("coulomb"), 0.05, scheme="localised")["slip"])


def test_linear_weakening_by_events_does_not_depend_on_the_order():
    scene = {"law": SLIP_WEAKENING, "dx": 0.05, "level": 0.8, "scheme": "localised"}
    fine = run(**scene, step=0.05, order=8)["slip"]
    for values in ({"step": 0.2}, {"order": 8}, {"order": 6, "half_lattice": False}):
        data = run(**scene, **values)
        assert float(np.abs(data["slip"] - fine).max()) < 2e-6
        assert data.attrs["re_releases"] == 0


def test_a_block_heals_when_it_sticks():
    """A block that stuck needs a stress of 1 to slide again, so none is released behind a pulse."""
    data = run(SLIP_WEAKENING, 0.05, 0.8, 30.0)
    assert data.attrs["re_releases"] == 0 and data.attrs["sticks"] > 100
    data = run(sp.friction("slip_weakening", d_c=0.1, nucleation=0.0), 0.05)
    assert np.isfinite(data["release_time"].values).sum() == 1
    assert float(data["slip"].max()) == 0.0


@pytest.mark.parametrize(
    ("law", "scheme", "allowed"),
    [
        ("bounded_rate", "localised", "fixed_step"),
        ("exponential_weakening", "localised", "fixed_step"),
        ("bounded_rate", "continuum", "fixed_step"),
        ("rate_weakening", "continuum", "localised or fixed_step"),
        ("slip_weakening", "continuum", "localised or fixed_step"),
    ],
)
def test_schemes_that_do_not_solve_a_law_refuse_it(law, scheme, allowed):
    refusal = rf"scheme: '{scheme}'; allowed: {allowed}, with friction law '{law}'"
    with pytest.raises(ValueError, match=refusal):
        run(sp.friction(law, **EXAMPLES[law]), 0.05, scheme=scheme)


def test_a_step_that_does_not_resolve_the_growth_of_slip_rate_is_refused():
    law = sp.friction("rate_weakening", slope=1000.0, limit=0.3)
    for scheme in ("localised", "fixed_step"):
        with pytest.raises(ValueError, match=r"max_step: 0.1; allowed: <= 0.01 \(in units of dx\)"):
            run(law, 0.05, scheme=scheme)
