"""Stress and motion of a finished run, recomputed from its slip with numpy alone.

Tests compare the lattice code with these numbers.
"""

import numpy as np
import xarray as xr


def sliding(run: xr.Dataset) -> np.ndarray:
    """Return which blocks slide at the end: those that were released and have not stuck since."""
    return np.isfinite(run["release_time"].values) & ~np.isfinite(run["stick_time"].values)


def second_difference(values: np.ndarray, dx: float) -> np.ndarray:
    """Return the second difference divided by dx^2 of an array that is 0 beyond its ends."""
    padded = np.concatenate([[0.0], values, [0.0]])
    return np.diff(padded, 2) / dx**2


def elastic_stress(run: xr.Dataset) -> np.ndarray:
    """Return the stress on each block without damping."""
    leaf_stiffness = run.attrs["gamma"] if run.attrs["boundary"] == "displacement" else 0.0
    slip = run["slip"].values
    leaf_stress = leaf_stiffness * slip
    return second_difference(slip, run.attrs["dx"]) - leaf_stress + run["prestress"].values


def total_stress(run: xr.Dataset) -> np.ndarray:
    """Return the stress on each block, with damping."""
    velocity = run["slip_velocity"].values
    damping_stress = run.attrs["beta"] * second_difference(velocity, run.attrs["dx"])
    return elastic_stress(run) + damping_stress


def threshold_stress(run: xr.Dataset) -> np.ndarray:
    """Return the stress that the run's release rule compares with 1."""
    return total_stress(run) if run.attrs["release"] == "total" else elastic_stress(run)
