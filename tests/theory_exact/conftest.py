"""If SLIPPULSE_NUDGED is set, change all inputs of the exact theory in their last digits."""

import dataclasses
import math
import os
import zlib

import numpy as np
import pytest

from slippulse.model.prestress import Prestress
from slippulse.theory import domains, fast_front, rupture


def nudged(value, rng: np.random.Generator):
    """Return numbers moved by 1 to 4 units in the last place; 0 remains 0.

    The value may be a number, an array, a tuple of these, or a pre-stress.
    """
    if isinstance(value, Prestress) and value.points:
        return nudged_table(value, rng)
    if isinstance(value, Prestress):
        return nudged_levels(value, rng)
    if isinstance(value, tuple):
        return tuple(nudged(part, rng) for part in value)
    if not isinstance(value, float | np.ndarray):
        return value
    value = np.asarray(value)
    units = rng.integers(1, 5, value.shape) * rng.choice([-1.0, 1.0], value.shape)
    moved = np.where(value == 0.0, 0.0, value + units * np.spacing(value))
    return moved if moved.ndim else float(moved)


def nudged_levels(prestress: Prestress, rng: np.random.Generator) -> Prestress:
    """Return a pre-stress without a table, with moved levels, steps and bumps.

    A symmetric pre-stress stays symmetric.
    """
    names = [field.name for field in dataclasses.fields(prestress) if field.name != "peak"]
    moved = {name: nudged(getattr(prestress, name), rng) for name in names}
    if prestress.symmetric:
        moved |= {"right": moved["left"], "steps": prestress.steps, "bumps": prestress.bumps}
    return dataclasses.replace(prestress, **moved)


def nudged_table(prestress: Prestress, rng: np.random.Generator) -> Prestress:
    """Return a table with moved points.

    Equal distances from x = 0 move alike, so that jumps and symmetry stay, and so does a value of 1
    or more, which nucleates.
    """
    distances, values = {}, {}
    for x, tau in prestress.points:
        distances.setdefault(abs(x), nudged(abs(x), rng))
        values.setdefault((abs(x), tau), tau if tau >= 1.0 else nudged(tau, rng))
    points = []
    for x, tau in prestress.points:
        moved_x = math.copysign(distances[abs(x)], x)
        points.append((moved_x, values[abs(x), tau]))
    (_, left), *_, (_, right) = points
    return dataclasses.replace(prestress, points=tuple(points), left=left, right=right)


@pytest.fixture(autouse=True)
def inputs_nudged_in_their_last_bits(monkeypatch):
    """Move arguments of a rupture, positions and times; the seed makes failures repeatable."""
    if not os.environ.get("SLIPPULSE_NUDGED"):
        return
    rng = np.random.default_rng(int(os.environ["SLIPPULSE_NUDGED"]))

    def nudged_law(**keys):
        # Half of a lattice is the same scene as the whole: equal arguments are moved equally.
        scene = keys["prestress"], keys["gamma"], keys["damping_ratio"]
        # The hash of None, which a pre-stress may contain, differs from run to run.
        rng = np.random.default_rng(zlib.crc32(repr(scene).encode()))
        return fast_front.FastFront(**{name: nudged(value, rng) for name, value in keys.items()})

    as_numbers = rupture.as_numbers
    monkeypatch.setattr(rupture, "FastFront", nudged_law)

    def nudged_numbers(key, value, **bounds):
        return np.array(nudged(as_numbers(key, value, **bounds), rng))

    for module in (rupture, domains):
        monkeypatch.setattr(module, "as_numbers", nudged_numbers)
