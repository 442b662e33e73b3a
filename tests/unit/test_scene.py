"""Values, symmetry, steps, bumps and integral of a pre-stress, and derived numbers of a scene."""

import dataclasses
from itertools import product

import numpy as np
import pandas as pd
import pytest
import tolerances as tol
import xarray as xr
from scipy.integrate import quad

import slippulse as sp
from slippulse.data.saving import save_dataset
from slippulse.data.store import load_dataset
from slippulse.data.tables import load_table, save_table
from slippulse.model.balance import integral
from slippulse.prediction.comparison import measured_table

STRESS = {"boundary": "stress", "prestress": sp.Prestress(-0.5, 0.0), "duration": 5.0, "dx": 0.01}
DISPLACEMENT = STRESS | {"boundary": "displacement", "gamma": 0.65, "beta": 1e-3}
DISPLACEMENT["prestress"] = sp.Prestress(0.5, 0.5)
SYMMETRIC = [{}, {"left": 0.0, "right": -0.0}, {"steps": ((5.0, 0.1), (-5.0, 0.1))}]
SYMMETRIC += [{"bumps": ((-4.0, 0.1, 1.0), (4.0, 0.1, 1.0), (0.0, 0.1, 1.0))}]
ASYMMETRIC = [{"right": 0.300001}, {"steps": ((5.0, 0.1), (-5.0, 0.2))}, {"steps": ((5.0, 0.1),)}]
ASYMMETRIC += [{"bumps": ((4.0, 0.1, 1.0),)}, {"bumps": ((4.0, 0.1, 1.0), (-4.0, 0.1, 2.0))}]
ASYMMETRIC += [{"bumps": ((4.0, 0.1, 1.0), (4.0, 0.1, 1.0), (-4.0, 0.1, 1.0))}]


def test_derived_numbers():
    scene = sp.Scene(**DISPLACEMENT, friction_ratio=2.0)
    assert (scene.damping_ratio, scene.reverse_threshold) == (pytest.approx(0.1), -5.0)
    others = dataclasses.replace(scene, half_lattice=False), sp.Scene(**STRESS)
    assert [one.symmetric for one in (scene, *others)] == [True, False, False]


UNEVEN = sp.Prestress(0.25, 0.6, 2.0, 1.05, steps=((4.0, 0.4),), bumps=((-3.0, -0.3, 0.5),))
CHANGED = {"release": "elastic", "half_lattice": False, "order": 5, "max_step": 0.25}
CHANGED |= {"friction_ratio": 2.0, "resolved_blocks": 3, "prestress": UNEVEN, "duration": 0.1}
OTHERS = {
    "displacement": sp.Scene(**DISPLACEMENT | CHANGED),
    "stress": sp.Scene(**STRESS | {"duration": 0.1}, scheme="fixed_step", max_step=0.3),
}


@pytest.mark.parametrize("boundary", OTHERS)
def test_a_scene_can_be_made_from_its_attributes_data_and_measured_row(boundary, config, tmp_path):
    scene = OTHERS[boundary]
    assert sp.Scene.from_attributes(scene.attributes()) == scene
    save_dataset(sp.run_sweep([scene], record=("fronts",)), tmp_path / "data.nc")
    data = load_dataset(tmp_path / "data.nc")
    assert sp.Scene.from_attributes(sp.point(data, 0).attrs) == scene
    save_table(measured_table(data, config["measure"]), tmp_path / "measured.csv")
    (row,) = load_table(tmp_path / "measured.csv").to_dict("records")
    assert sp.Scene.from_attributes(row) == scene


def test_a_run_saved_by_xarray_can_be_measured_and_drawn(tmp_path):
    """A file has integers and floats of numpy, whereas a run has integers and floats of Python."""
    scene = sp.Scene(**DISPLACEMENT | {"dx": 0.1, "duration": 6.0, "half_lattice": False})
    run = sp.simulate(scene, sp.Samples([0.0, 3.0], [0.0, 1.0]))
    run.to_netcdf(tmp_path / "run.nc")
    with xr.open_dataset(tmp_path / "run.nc") as opened:
        assert sp.Scene.from_attributes(opened.attrs) == scene
        assert type(sp.Scene.from_attributes(opened.attrs).order) is int
        pd.testing.assert_series_equal(pd.Series(sp.measure(opened)), pd.Series(sp.measure(run)))
        assert sp.plot(opened).axes
    sweep = sp.run_sweep([scene, scene])
    sweep.to_netcdf(tmp_path / "sweep.nc")
    with xr.open_dataset(tmp_path / "sweep.nc") as opened:
        assert sp.Scene.from_attributes(sp.point(opened, 1).attrs) == scene


def test_samples_keep_unchangeable_copies_of_their_arrays():
    times, positions = np.array([1.0, 2.0, 4.0]), np.array([0.5])
    samples = sp.Samples(times, positions)
    scene = sp.Scene(**DISPLACEMENT | {"dx": 0.1})
    expected = sp.simulate(scene, samples)
    times[:], positions[:] = [4.0, 2.0, 1.0], 9.0
    run = sp.simulate(scene, samples)
    assert run.identical(expected) and samples.times.tolist() == [1.0, 2.0, 4.0]
    with pytest.raises(ValueError, match="read-only"):
        samples.times[0] = 3.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        samples.times = times


def test_a_pre_stress_keeps_unchangeable_copies_of_its_parts():
    steps, bumps = [[3.0, 0.1]], [[4.0, 0.1, 1.0]]
    profile = sp.Prestress(0.3, 0.3, steps=steps, bumps=bumps)
    steps[0][1], bumps[0][1] = 0.9, 0.9
    assert profile.steps == ((3.0, 0.1),) and profile.bumps == ((4.0, 0.1, 1.0),)
    assert isinstance(profile.intervals, tuple)


def test_attributes_without_a_parameter_are_refused_by_its_name():
    attributes = sp.Scene(**STRESS).attributes()
    # Files from before other laws are of the paper's model, or of friction linear in slip rate.
    del attributes["friction"]
    assert sp.Scene.from_attributes(attributes).friction == sp.friction("coulomb")
    strengthened = sp.Scene.from_attributes(attributes | {"rate_strengthening": 0.4})
    assert strengthened.friction == sp.friction("linear_rate", alpha=0.4)
    del attributes["steps_and_bumps"]
    with pytest.raises(
        ValueError, match="steps_and_bumps: missing; allowed: a mapping with every attribute of"
    ):
        sp.Scene.from_attributes(attributes)


@pytest.mark.parametrize("kind", [np.float32, int])
def test_parameters_are_converted_to_double_precision(kind):
    """A spacing squared in single precision would change the seventh digit of a result."""
    values = {"duration": kind(7), "dx": kind(1), "gamma": kind(1), "beta": kind(0)}
    scene = sp.Scene("displacement", sp.Prestress(kind(0), kind(0), kind(2), kind(1)), **values)
    of_scene = [getattr(scene, name) for name in (*values, "max_step", "friction_ratio")]
    profile = [getattr(scene.prestress, name) for name in ("left", "right", "width", "peak")]
    assert {type(value) for value in of_scene + profile} == {float}


STEPS = ((15.0, -0.1), (-4.0, 0.2), (20.0, 0.4))
PROFILES = {
    "even": sp.Prestress(0.3, 0.3),
    "wide": sp.Prestress(-0.75, 0.0, width=5.0),
    "low peak": sp.Prestress(0.2, -0.4, width=0.5, peak=0.9),
    "steps": sp.Prestress(-0.3, 0.0, steps=STEPS),
    "bumps": sp.Prestress(0.3, 0.5, bumps=((6.0, -0.4, 0.5), (-3.0, 0.2, 1.5))),
    "both": sp.Prestress(0.3, 0.3, 2.0, 1.0, ((-7.0, -0.2),), ((3.0, 0.1, 0.2), (0.0, 0.05, 4.0))),
}


@pytest.mark.parametrize("peak", [1.0, 0.1 + 0.2, 1.0 - 1e-16, 1.3])
@pytest.mark.parametrize(("left", "right"), [(0.1, 0.7), (-1.3, 0.0), (0.999999, 0.3)])
def test_the_value_at_the_nucleation_point_is_exactly_the_peak(left, right, peak):
    profile = sp.Prestress(left, right, peak=peak)
    assert float(profile(0.0)) == profile(np.array([-0.1, 0.0, 0.1]))[1] == peak


def test_the_profile_is_a_gaussian_on_its_side_levels_and_bumps_are_added():
    x = np.linspace(-40.0, 40.0, 401)
    level = np.where(x < 0.0, -0.75, 0.25)
    expected = level + (1.0 - level) * np.exp(-(x**2) / 50.0)
    assert sp.Prestress(-0.75, 0.25, width=5.0)(x) == pytest.approx(expected, abs=tol.STENCIL)
    assert sp.Prestress(-0.75, 0.25, width=5.0)(np.array([-300.0, 300.0])).tolist() == [-0.75, 0.25]
    added = -0.4 * np.exp(-0.5 * ((x - 6.0) / 0.5) ** 2)
    added += 0.2 * np.exp(-0.5 * ((x + 3.0) / 1.5) ** 2)
    assert PROFILES["bumps"](x) - sp.Prestress(0.3, 0.5)(x) == pytest.approx(added, abs=tol.STENCIL)


@pytest.mark.parametrize("steps", [STEPS, STEPS[::-1]])
def test_a_step_replaces_the_level_beyond_its_position_on_its_side(steps):
    profile = sp.Prestress(-0.3, 0.0, steps=steps)
    x = np.array([-50.0, -4.0, -3.999, 0.0, 14.999, 15.0, 19.999, 20.0, 99.0])
    assert profile.level(x).tolist() == [0.2, 0.2, -0.3, 0.0, 0.0, -0.1, -0.1, 0.4, 0.4]
    assert np.array_equal(profile(x), PROFILES["steps"](x))


@pytest.mark.parametrize(
    ("symmetric", "values"), [*product([True], SYMMETRIC), *product([False], ASYMMETRIC)]
)
def test_a_profile_is_symmetric_if_its_values_are(symmetric, values):
    profile, x = sp.Prestress(**{"left": 0.3, "right": 0.3} | values), np.linspace(0.0, 20.0, 2001)
    assert profile.symmetric is symmetric
    assert np.allclose(profile(x), profile(-x), rtol=0.0, atol=tol.STENCIL) is symmetric


@pytest.mark.parametrize("ends", [(-9.0, 25.0), (2.0, 3.0), (4.0, -7.5), (1.0, 1.0), (15.0, 18.0)])
@pytest.mark.parametrize("name", PROFILES)
def test_the_integral_equals_a_numerical_integral(name, ends):
    profile = PROFILES[name]
    marks = [0.0, *(p for p, _ in profile.steps), *(c for c, _, _ in profile.bumps)]
    inside = [mark for mark in marks if min(ends) < mark < max(ends)] or None
    accuracy = {"points": inside, "epsabs": 1e-13, "epsrel": 1e-12, "limit": 400}
    expected, _ = quad(lambda x: float(profile(x)), *ends, **accuracy)
    assert integral(profile, *ends) == pytest.approx(expected, abs=tol.QUADRATURE)


@pytest.mark.parametrize("width", [1e-200, 1.0, 1e300])
def test_the_balance_position_has_its_closed_form(width):
    """Far from the peak the integral is that of the level and of two halves of a Gaussian."""
    position = sp.theory.prestress_balance_position(sp.Prestress(-0.1, 0.0, width))
    assert position / width == pytest.approx(-21.0 * np.sqrt(0.5 * np.pi), rel=tol.ALGEBRA)


def test_a_pre_stress_without_balance_is_refused():
    with pytest.raises(ArithmeticError, match="no balance position at x < 0"):
        sp.theory.prestress_balance_position(sp.Prestress(-0.5, 0.0, bumps=((5.0, -3.0, 2.0),)))
