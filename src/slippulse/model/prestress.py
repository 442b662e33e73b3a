"""The pre-stress profile: a Gaussian peak on side levels, with optional steps and bumps."""

import json
import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import groupby, pairwise
from operator import itemgetter
from typing import Any

import numpy as np

from .checks import as_positions, check_number, check_that, short_repr
from .removed import AnswersRemoved

# Bounds, for `check_number`. A level at the threshold would release block after block at t = 0,
# without end.
LEVEL: dict[str, Any] = {"below": 1.0}
NUMBERS = {"left": LEVEL, "right": LEVEL, "width": {"above": 0.0}, "peak": {}}
PARTS = {
    "steps": {"position": {}, "level": LEVEL},
    "bumps": {"centre": {}, "amplitude": {}, "width": {"above": 0.0}},
}


@dataclass(frozen=True)
class Prestress(AnswersRemoved):
    """Non-dimensional pre-stress tau(x), with nucleation at x = 0.

    The profile is ``level(x) + (peak - level(x)) exp(-x^2 / 2 width^2) + bumps``, where ``level``
    is ``left`` for x < 0 and ``right`` for x >= 0 until a step replaces it. A block is released
    where the profile reaches 1. Source: section III of the paper; steps and bumps are an addition
    of this project.

    Parameters
    ----------
    left, right : float, units of the stress drop
        Levels at large distance on either side (tau_{0,l} and tau_{0,r}), < 1.
    width : float, units of H
        Standard deviation W of the Gaussian, > 0.
    peak : float, units of the stress drop
        Value at x = 0. At 1 the block there is released at t = 0; below 1 nothing moves.
    steps : sequence of (position, level)
        From the position on, away from x = 0, the level of its side becomes this.
    bumps : sequence of (centre, amplitude, width)
        Gaussians added: a barrier (amplitude < 0), an asperity, or a second nucleation.

    Raises
    ------
    ValueError
        If a value is not a finite number, a width is not positive, or a step lies at x = 0.

    Examples
    --------
    >>> barrier = sp.Prestress(left=0.6, right=0.6, bumps=((8.0, -0.3, 0.5),))
    >>> float(barrier(0.0))
    1.0
    """

    left: float
    right: float
    width: float = 1.0
    peak: float = 1.0
    steps: tuple[tuple[float, float], ...] = ()
    bumps: tuple[tuple[float, float, float], ...] = ()

    def __post_init__(self) -> None:
        for name, bounds in NUMBERS.items():
            check_number(f"prestress.{name}", getattr(self, name), **bounds)
            object.__setattr__(self, name, float(getattr(self, name)))
        for name, parts in PARTS.items():
            rows = _number_tuples(f"prestress.{name}", getattr(self, name), parts)
            object.__setattr__(self, name, rows)
        positions = [position for position, _ in self.steps]
        different = 0.0 not in positions and len({*positions}) == len(positions)
        allowed = "different positions, none of them 0 (see left, right)"
        check_that(different, "prestress.steps", positions, allowed)

    @property
    def symmetric(self) -> bool:
        """True where tau(-x) = tau(x), so that half the lattice is enough."""
        parts = {*self.steps, *self.bumps}
        mirrored = {(-position, *rest) for position, *rest in parts}
        return self.left == self.right and parts == mirrored

    def level(self, x: np.ndarray | float) -> np.ndarray:
        """Side level at positions x (units of H), with the steps, without Gaussian and bumps."""
        x = as_positions("x", x)
        level = np.where(x < 0.0, self.left, self.right)
        for position, value in sorted(self.steps, key=lambda step: abs(step[0])):
            level = np.where(x * math.copysign(1.0, position) >= abs(position), value, level)
        return level

    @cached_property
    def intervals(self) -> tuple[tuple[float, float, float], ...]:
        """Left end, right end and level of each interval of constant side level, left to right."""
        jumps = sorted({0.0}.union(position for position, _ in self.steps))
        middles = [0.5 * (left + right) for left, right in pairwise(jumps)]
        levels = self.level(np.array([jumps[0] - 1.0, *middles, jumps[-1] + 1.0])).tolist()
        ends = [-math.inf, *jumps, math.inf]
        return tuple(zip(ends[:-1], ends[1:], levels, strict=True))

    def __call__(self, x: np.ndarray | float) -> np.ndarray:
        """Pre-stress at positions x (units of H), exactly ``peak`` at x = 0 without bumps."""
        x = as_positions("x", x)
        # Written with 1 - exp, nothing cancels near x = 0, where the threshold is met.
        tau = self.peak + (self.level(x) - self.peak) * -np.expm1(-0.5 * (x / self.width) ** 2)
        if not self.bumps:
            return tau
        # Bumps at equal distances are first added to each other, so that a mirrored profile is
        # mirrored to the last bit.
        bumps = sorted((abs(centre), *shape, centre) for centre, *shape in self.bumps)
        for (_, size, width), equal in groupby(bumps, key=itemgetter(0, 1, 2)):
            tau = tau + sum(size * np.exp(-0.5 * ((x - bump[3]) / width) ** 2) for bump in equal)
        # The tail of a distant bump leaves the peak within rounding of the threshold, which it is
        # meant to meet.
        return np.where(np.abs(tau - 1.0) <= 4.0 * sys.float_info.epsilon, 1.0, tau)


def prestress_from(attributes: Mapping) -> Prestress:
    """The pre-stress of a data file's attributes; KeyError if one is missing, or ValueError."""
    numbers = {name: attributes[name] for name in NUMBERS}
    text = attributes["steps_and_bumps"]
    try:
        parts = {name: json.loads(text)[name] for name in PARTS}
    except (TypeError, ValueError, LookupError):
        allowed = "a JSON object of steps and bumps"
        raise ValueError(f"steps_and_bumps: {short_repr(text)}; allowed: {allowed}") from None
    return Prestress(**numbers, **parts)


def _number_tuples(key: str, rows: Any, parts: Mapping[str, Mapping]) -> tuple[tuple, ...]:
    allowed = f"a list of [{', '.join(parts)}]"
    try:
        named = [dict(zip(parts, row, strict=True)) for row in rows]
    except (TypeError, ValueError):
        raise ValueError(f"{key}: {short_repr(rows)}; allowed: {allowed}") from None
    for row in named:
        for part, value in row.items():
            check_number(f"{key} {part}", value, **parts[part])
    return tuple(tuple(map(float, row.values())) for row in named)
