"""Stress and motion of a finished run, recomputed from its slip with numpy alone."""

import numpy as np
import xarray as xr


def sliding(run: xr.Dataset) -> np.ndarray:
    """Mask of the blocks that slide at the end: released and not stuck since."""
    return np.isfinite(run["release_time"].values) & ~np.isfinite(run["stick_time"].values)


def second_difference(values: np.ndarray, dx: float) -> np.ndarray:
    """Second difference over dx^2 of an array that is 0 beyond its ends."""
    return np.diff(np.concatenate([[0.0], values, [0.0]]), 2) / dx**2


def elastic_stress(run: xr.Dataset) -> np.ndarray:
    leaf = run.attrs["gamma"] if run.attrs["boundary"] == "displacement" else 0.0
    slip = run["slip"].values
    return second_difference(slip, run.attrs["dx"]) - leaf * slip + run["prestress"].values


def total_stress(run: xr.Dataset) -> np.ndarray:
    drag = run.attrs["beta"] * second_difference(run["slip_velocity"].values, run.attrs["dx"])
    return elastic_stress(run) + drag


def threshold_stress(run: xr.Dataset) -> np.ndarray:
    """The stress that the run's release rule compares with 1."""
    return total_stress(run) if run.attrs["release"] == "total" else elastic_stress(run)
