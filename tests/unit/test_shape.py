"""The shape of made-up pulses: half-width, waves of the lattice, blocks at once, and what changes far away."""

import numpy as np
import pytest
import xarray as xr

from slippulse.measure.pulses import LeadingPulse
from slippulse.measure.shape import far_field, half_width, lattice_noise, sliding_at_once
from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene

PULSE = LeadingPulse(10.0, 1.0, 4.0, 1.0, 8.0, 1.0)


def fields(velocity: np.ndarray) -> xr.Dataset:
    """A run with slip velocity at the end, at a spacing of 0.01."""
    zero = ("x", np.zeros(velocity.size))
    named = {"slip_velocity": ("x", velocity), "slip": zero, "slip_acceleration": zero}
    return xr.Dataset(named, {"x": 0.01 * np.arange(velocity.size)})


def test_the_half_width_of_a_gaussian():
    x = 0.01 * np.arange(1601)
    run = fields(np.exp(-0.5 * ((x - 8.0) / 0.7) ** 2))
    assert half_width(run, PULSE) == pytest.approx(2.0 * 0.7 * np.sqrt(2.0 * np.log(2.0)), rel=1e-4)
    assert np.isnan(half_width(fields(np.exp(-x)), PULSE))


def test_waves_of_the_lattice_count_and_an_even_pulse_has_none():
    x = 0.01 * np.arange(1601)
    even = np.where(np.abs(x - 8.0) < 2.0, np.cos(0.25 * np.pi * (x - 8.0)), 0.0)
    assert lattice_noise(fields(even)) < 1e-15
    # Waves of two blocks pass wholly, waves of four to a sixteenth of their power.
    for period, gain in ((2, 1.0), (4, 1.0 / 16.0)):
        wave = np.where(even > 0.0, 1e-2 * np.cos(2.0 * np.pi * np.arange(x.size) / period), 0.0)
        expected = gain * np.sum(wave**2) / np.sum(even**2)
        assert lattice_noise(fields(even + (even > 0.05) * wave)) == pytest.approx(expected, rel=0.1)
    assert np.isnan(lattice_noise(fields(np.zeros(100))))


def test_blocks_that_slide_at_once():
    x = np.arange(-6.0, 7.0)
    release = np.abs(x)
    # Each slides for 1.5; the last three to the right are still sliding.
    stick = np.where(x > 3.0, np.nan, release + 1.5)
    times = {"release_time": ("x", release), "stick_time": ("x", stick)}
    assert sliding_at_once(xr.Dataset(times, {"x": x}, {"end_time": 6.5})) == 3.0


def moving(speed: float, growth: float = 0.0, left: float = 0.0) -> xr.Dataset:
    """A Gaussian pulse of slip velocity that runs right, u = f(x - t), with a strain left behind."""
    times, x = np.linspace(0.0, 30.0, 4), np.linspace(-40.0, 40.0, 8001)
    centre = 2.0 + speed * times[:, None]
    size = 1.0 + growth * times[:, None]
    velocity = size * np.exp(-0.5 * ((x - centre) / 0.8) ** 2)
    velocity[velocity < 1e-5] = 0.0
    slip = np.cumsum(velocity[:, ::-1], axis=1)[:, ::-1] * (x[1] - x[0]) - left * np.minimum(x, centre)
    axes = ("sample_time", "sample_position")
    scene = Scene("stress", Prestress(-0.5, 0.0), duration=30.0, dx=0.01).attributes()
    sampled = {"sample_velocity": (axes, velocity), "sample_slip": (axes, slip)}
    return xr.Dataset(sampled, {"sample_time": times, "sample_position": x}, scene)


@pytest.mark.parametrize(
    ("run", "expected"),
    [
        # One that keeps its shape changes nothing.
        (moving(1.0), {"profile_change": 0.0, "energy_change": 0.0, "strain_left": 0.0}),
        (moving(1.0, 0.01), {"energy_change": (1.3 / 1.2) ** 2 - 1.0, "profile_change": 0.1 / 1.2}),
        (moving(1.0, left=0.1), {"strain_left": 0.1 / 1.1}),
        # Nothing is said of a pulse that never comes far.
        (moving(0.0), {"profile_change": np.nan}),
    ],
)
def test_what_changes_is_measured(run, expected):
    found = far_field(run)
    for quantity, value in expected.items():
        assert found[quantity] == pytest.approx(value, rel=0.03, abs=1e-3, nan_ok=True)


def test_a_slower_pulse_does_not_keep_its_profile_at_the_wave_speed():
    assert far_field(moving(0.95))["profile_change"] > 0.2
