"""What must not change a result: the mirror, half the lattice, the size of the first lattice."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
import tolerances as tol

import slippulse as sp
from slippulse.model.scene import LATTICE_SCHEMES
from slippulse.solver import lattice

FIELDS = ("release_time", "stick_time", "slip", "slip_velocity", "slip_acceleration")
COUNTS = ("releases", "sticks", "re_releases")
# The peak is a little above 1: bumps add to it.
UNEVEN = sp.Prestress(0.25, 0.6, peak=1.05, steps=((4.0, 0.4),), bumps=((-3.0, -0.3, 0.5),))
MIRRORED = sp.Prestress(0.6, 0.25, peak=1.05, steps=((-4.0, 0.4),), bumps=((3.0, -0.3, 0.5),))
EVEN = sp.Prestress(0.4, 0.4, peak=1.05, bumps=((5.0, -0.5, 0.7), (-5.0, -0.5, 0.7)))


def simulated(profile, boundary="displacement", scheme="localised", ratio=0.1, **changes):
    gamma = 0.65 if boundary == "displacement" else 0.0
    values = {"gamma": gamma, "beta": ratio * 0.05, "scheme": scheme, "max_step": 0.3, **changes}
    return sp.simulate(sp.Scene(boundary, profile, 8.0, 0.05, **values))


def largest_difference(one, two) -> float:
    assert np.array_equal(one["x"].values, two["x"].values)
    largest = 0.0
    for name in FIELDS:
        a, b = one[name].values, two[name].values
        assert np.array_equal(np.isfinite(a), np.isfinite(b)), name
        largest = max(largest, float(np.max(np.abs(a - b), where=np.isfinite(a), initial=0.0)))
    return largest


@pytest.mark.parametrize("ratio", [0.0, 0.1])
@pytest.mark.parametrize("scheme", LATTICE_SCHEMES)
@pytest.mark.parametrize("boundary", ["displacement", "stress"])
def test_the_mirror_image_of_a_scene_has_the_mirror_image_of_its_result(boundary, scheme, ratio):
    one = simulated(UNEVEN, boundary, scheme, ratio)
    two = simulated(MIRRORED, boundary, scheme, ratio).isel(x=slice(None, None, -1))
    two = two.assign_coords(x=-two["x"])
    assert one.attrs["releases"] > 100
    assert largest_difference(one, two) < tol.MIRROR
    assert [one.attrs[name] for name in COUNTS] == [two.attrs[name] for name in COUNTS]


@pytest.mark.parametrize("ratio", [0.0, 0.1])
@pytest.mark.parametrize("scheme", LATTICE_SCHEMES)
@pytest.mark.parametrize("boundary", ["displacement", "stress"])
def test_half_the_lattice_gives_the_whole_result(boundary, scheme, ratio):
    half = simulated(EVEN, boundary, scheme, ratio)
    whole = simulated(EVEN, boundary, scheme, ratio, half_lattice=False)
    assert whole.attrs["releases"] > 100
    assert half.attrs["half_lattice_used"] == 1 and whole.attrs["half_lattice_used"] == 0
    assert largest_difference(half, whole) < tol.MIRROR
    for name in (
        "work_of_prestress",
        "kinetic_energy",
        "elastic_energy",
        "leaf_spring_energy",
        "viscous_loss",
        "min_stuck_stress",
        "first_stick_time",
    ):
        assert half.attrs[name] == pytest.approx(whole.attrs[name], rel=1e3 * tol.MIRROR, nan_ok=True), name


@pytest.mark.parametrize("scheme", LATTICE_SCHEMES)
@pytest.mark.parametrize("profile", [EVEN, UNEVEN], ids=["even", "uneven"])
def test_the_size_of_the_first_lattice_does_not_change_a_bit(monkeypatch, profile, scheme):
    whole = simulated(profile, scheme=scheme)
    for name, value in {"FIRST_BLOCKS": 16, "PAGE": 8, "BEYOND_PAGES": 3}.items():
        monkeypatch.setattr(lattice, name, value)
    grown = simulated(profile, scheme=scheme)
    assert grown.equals(whole)
    assert grown.attrs["block_updates"] == whole.attrs["block_updates"]


def test_the_length_of_a_call_does_not_change_a_bit(monkeypatch):
    scene = sp.Scene("displacement", UNEVEN, 8.0, 0.05, gamma=0.65, beta=0.005, max_step=0.3)
    whole = sp.simulate(scene)
    monkeypatch.setattr(lattice, "CALL_STEPS", 7)
    shares = []
    assert sp.simulate(scene, progress=shares.append).equals(whole)
    assert len(shares) > 10
    assert shares == sorted(shares) and shares[0] > 0.0 and shares[-1] <= 1.0


def test_a_longer_run_begins_with_the_shorter_one():
    scene = sp.Scene("displacement", UNEVEN, 8.0, 0.05, gamma=0.65, beta=0.005, max_step=0.3)
    long, short = sp.simulate(scene), sp.simulate(dataclasses.replace(scene, duration=5.0))
    early = long["release_time"].values <= 5.0
    assert np.nanmax(short["release_time"].values) <= 5.0
    positions = long["x"].values[early]
    assert short["release_time"].sel(x=positions).values == pytest.approx(
        long["release_time"].values[early], abs=tol.MIRROR
    )
