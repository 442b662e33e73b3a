"""Inputs moved in their last bits."""

import dataclasses

import numpy as np

from slippulse.model.prestress import Prestress


def nudged(value, rng: np.random.Generator):
    """Numbers moved by 1 to 4 units in the last place, in tuples, arrays, a pre-stress; 0 stays."""
    if isinstance(value, Prestress):
        names = [field.name for field in dataclasses.fields(value) if field.name != "peak"]
        moved = {name: nudged(getattr(value, name), rng) for name in names}
        if value.symmetric:
            moved |= {"right": moved["left"], "steps": value.steps, "bumps": value.bumps}
        return dataclasses.replace(value, **moved)
    if isinstance(value, tuple):
        return tuple(nudged(part, rng) for part in value)
    if not isinstance(value, float | np.ndarray):
        return value
    value = np.asarray(value)
    units = rng.integers(1, 5, value.shape) * rng.choice([-1.0, 1.0], value.shape)
    moved = np.where(value == 0.0, 0.0, value + units * np.spacing(value))
    return moved if moved.ndim else float(moved)
