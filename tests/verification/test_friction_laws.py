"""Other laws of friction on lattices: energy, healing, and the steady ruptures of theory."""

import numpy as np
import pytest

import slippulse as sp
from slippulse import theory
from slippulse.model.friction import LAWS

GAMMA, BETA = 2.0 / 3.0, 0.05
SPACINGS = (0.08, 0.04, 0.02)
# Work against friction is summed to second order in the step.
ENERGY = 1e-5
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
    assert fine["energy_residual"] < ENERGY
    assert fine["energy_residual"] < 0.4 * coarse["energy_residual"]
    assert np.sign(fine["friction_loss"]) == (-1.0 if law == "rate_weakening" else 1.0)


@pytest.mark.parametrize("law", ["slip_weakening", "exponential_weakening"])
def test_the_work_against_friction_is_the_fracture_energy_of_the_path(law):
    """Exponential weakening by 50 d_c and more pays d_c a length, linear weakening d_c/2."""
    data = run(sp.friction(law, d_c=0.02, nucleation=2.0), 0.02, 0.8, 12.0, step=0.05)
    done = (np.abs(data["x"].values) >= 2.0) & (data["slip"].values > 0.0)
    per_length = 0.02 if law == "exponential_weakening" else 0.01
    # Blocks at the fronts are on their way.
    assert data.attrs["friction_loss"] == pytest.approx(per_length * 0.02 * done.sum(), rel=0.03)


@pytest.mark.parametrize(("scheme", "least"), [("fixed_step", 1.0), ("localised", 3.0)])
@pytest.mark.parametrize(
    ("level", "d_c", "sticks"), [(0.8, 0.1, True), (0.5, 0.2, True), (0.5, 0.3, False)]
)
def test_lattices_tend_to_the_rupture_of_linear_weakening(level, d_c, sticks, scheme, least):
    """By events at second order: the error falls by a factor of at least 3 as spacing is halved."""
    exact = theory.weakening_pulse(level, GAMMA, BETA, d_c)
    law = sp.friction("slip_weakening", d_c=d_c, nucleation=2.0)
    runs = [run(law, dx, level, scheme=scheme) for dx in SPACINGS]
    measured = [sp.measure(data) for data in runs]
    assert scheme == "fixed_step" or max(data.attrs["energy_residual"] for data in runs) < ENERGY
    assert exact.sticks == sticks
    expected = {"front_speed_right": exact.speed} | ({"pulse_slip": exact.slip} if sticks else {})
    for name, value in expected.items():
        errors = np.abs([numbers[name] / value - 1.0 for numbers in measured])
        assert errors[2] < 5e-4 and (errors[:2] > least * errors[1:]).all()
    assert not sticks or measured[2]["pulse_width"] == pytest.approx(exact.width, rel=0.02)


@pytest.mark.parametrize(("law", "ratio"), [("bounded_rate", 0.1), ("rate_weakening", 0.0)])
def test_lattices_tend_to_the_steady_pulse_of_a_bounded_law_of_slip_rate(law, ratio):
    friction = sp.friction(law, **EXAMPLES[law])
    exact = theory.rate_pulse(0.5, GAMMA, ratio, friction)
    how = {"duration": 25.0, "step": 0.0213}
    measured = [sp.measure(run(friction, dx, beta=ratio * dx, **how)) for dx in SPACINGS]
    errors = [abs(numbers["pulse_slip"] / exact.slip - 1.0) for numbers in measured]
    assert errors[0] >= errors[1] >= errors[2] and errors[2] < 5e-3
    # Fronts of this scheme lock to a whole number of steps a block.
    if ratio:
        assert measured[2]["front_speed_right"] == pytest.approx(exact.speed, rel=0.01)
        assert measured[2]["pulse_peak_velocity"] == pytest.approx(exact.peak_velocity, rel=0.01)
        assert measured[2]["pulse_width"] == pytest.approx(exact.width, rel=0.02)


def by_events(dx, **values):
    law = sp.friction("slip_weakening", d_c=0.1, nucleation=2.0)
    return run(law, dx, 0.8, scheme="localised", **values)


def test_at_a_fixed_damping_ratio_the_front_tends_to_the_wave_speed():
    """Theory has v^2 - 1 in proportion to (beta v)^(2/3): a factor 0.4 from first to last."""
    speeds = [sp.measure(by_events(dx, beta=0.5 * dx))["front_speed_right"] for dx in SPACINGS]
    assert speeds[0] > speeds[1] > speeds[2] > 1.0
    assert speeds[2] - 1.0 == pytest.approx(0.4 * (speeds[0] - 1.0), rel=0.15)


def test_linear_weakening_by_events_is_the_limit_of_short_steps_whatever_the_order():
    law = sp.friction("slip_weakening", d_c=0.1, nucleation=2.0)
    localised = by_events(0.05, duration=15.0)
    errors = []
    for step in (0.04, 0.02):
        textbook = run(law, 0.05, 0.8, 15.0, step=step)
        errors.append(float(np.abs(textbook["release_time"] - localised["release_time"]).max()))
    assert errors[1] < 0.6 * errors[0] and errors[1] < 0.02
    fine = by_events(0.05, step=0.05, order=8)["slip"]
    for values in ({"step": 0.2}, {"order": 8}, {"order": 6, "half_lattice": False}):
        data = by_events(0.05, **values)
        assert float(np.abs(data["slip"] - fine).max()) < 2e-6
        assert data.attrs["re_releases"] == 0


def test_a_block_heals_when_it_sticks():
    """It needs a stress of 1 again: no block slides back and forth behind a pulse."""
    data = run(sp.friction("slip_weakening", d_c=0.1, nucleation=2.0), 0.05, 0.8, 30.0)
    assert data.attrs["re_releases"] == 0 and data.attrs["sticks"] > 100
    data = run(sp.friction("slip_weakening", d_c=0.1, nucleation=0.0), 0.05)
    assert np.isfinite(data["release_time"].values).sum() == 1
    assert float(data["slip"].max()) == 0.0


@pytest.mark.parametrize(
    ("law", "scheme", "allowed"),
    [
        ("bounded_rate", "localised", "fixed_step"),
        ("rate_weakening", "localised", "fixed_step"),
        ("exponential_weakening", "localised", "fixed_step"),
        ("bounded_rate", "continuum", "fixed_step"),
        ("slip_weakening", "continuum", "localised or fixed_step"),
    ],
)
def test_schemes_that_do_not_solve_a_law_refuse_it(law, scheme, allowed):
    refusal = rf"scheme: '{scheme}'; allowed: {allowed}, with friction law '{law}'"
    with pytest.raises(ValueError, match=refusal):
        run(sp.friction(law, **EXAMPLES[law]), 0.05, scheme=scheme)
