"""Invariants of the model over hundreds of random valid scenes, extremes included."""

from __future__ import annotations

import collections
import dataclasses
import math

import numpy as np
import tolerances as tol
from hypothesis import HealthCheck, given, settings
from reference.random_scenes import random_scenes

import slippulse as sp

FIELDS = ("release_time", "stick_time", "slip", "slip_velocity", "slip_acceleration")
SETTINGS = settings(
    max_examples=600, derandomize=True, deadline=None, database=None, suppress_health_check=list(HealthCheck)
)
# How often the scenes are of a kind.
seen: collections.Counter = collections.Counter()


@SETTINGS
@given(random_scenes())
def check_invariants(scene):
    reach = math.ceil(scene.duration) + 2.0
    samples = sp.Samples(np.linspace(0.0, scene.duration, 25), np.linspace(-reach, reach, 41))
    run = sp.simulate(scene, samples)
    release, stick = run["release_time"].values, run["stick_time"].values
    seen.update(
        {
            "scenes": 1,
            "in which blocks slip": int(np.isfinite(release).any()),
            "in which blocks stick": int(np.isfinite(stick).any()),
            "asymmetric": int(not scene.symmetric),
            "stress boundary": int(scene.boundary == "stress"),
            "textbook scheme": int(scene.scheme == "fixed_step"),
            "strongly damped": int(scene.damping_ratio >= 1.0),
        }
    )

    # Slip velocity is never negative, slip never decreases.
    for name in ("slip_velocity", "sample_velocity"):
        assert np.nanmin(run[name].values) >= 0.0
    assert np.nanmin(np.diff(run["sample_slip"].values, axis=0)) >= 0.0

    # Nothing is released before a neighbour: fronts run outwards from what was released at the start.
    late = np.where(np.isfinite(release), release, np.inf)
    after = np.flatnonzero(np.isfinite(release) & (release > 0.0))
    assert np.all(np.minimum(late[after - 1], late[after + 1]) <= release[after])
    # A block sticks after it was released.
    assert np.all(stick[np.isfinite(stick)] >= release[np.isfinite(stick)])

    # The energy balance is kept, or the run is flagged, whatever the scheme.
    flagged = "energy" in run.attrs["run_flags"]
    assert flagged == (run.attrs["energy_residual"] > tol.RANDOM_ENERGY)
    if scene.scheme == "localised":
        stuck = threshold_stress(run)[1:-1][~sliding(run)[1:-1]]
        assert np.max(stuck, initial=-np.inf) <= 1.0 + tol.STRESS_AT_END
        # Flagged only where the run is coarse or strongly damped.
        assert not flagged or run.attrs["steps"] < 20 or scene.order == 3 or scene.damping_ratio >= 1.0
        seen["flagged for energy"] += flagged

    other = sp.simulate(mirrored(scene))
    assert other.sizes == {"x": run.sizes["x"]}
    for name in FIELDS:
        one, two = run[name].values, other[name].values[::-1]
        assert np.array_equal(np.isfinite(one), np.isfinite(two))
        assert np.max(np.abs(one - two), where=np.isfinite(one), initial=0.0) < tol.MIRROR


def mirrored(scene: sp.Scene) -> sp.Scene:
    """The same scene with left and right exchanged."""
    profile = scene.prestress
    steps, bumps = (tuple((-x, *rest) for x, *rest in parts) for parts in (profile.steps, profile.bumps))
    turned = dataclasses.replace(profile, left=profile.right, right=profile.left, steps=steps, bumps=bumps)
    return dataclasses.replace(scene, prestress=turned)


def test_invariants_hold_over_varied_scenes():
    check_invariants()
    assert seen["scenes"] >= 500
    assert seen["in which blocks slip"] > 0.5 * seen["scenes"]
    assert seen["flagged for energy"] < tol.RANDOM_ENERGY_FLAGGED * seen["scenes"]
    for kind in (
        "in which blocks stick", "asymmetric", "stress boundary", "textbook scheme", "strongly damped",
    ):  # fmt: skip
        assert tol.RANDOM_SHARE * seen["scenes"] < seen[kind] < 0.95 * seen["scenes"], (kind, seen)
