"""The pre-stress profile: a Gaussian peak on side levels, with optional steps and bumps."""

import json
import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import groupby, pairwise
from numbers import Real
from typing import Any

import numpy as np

from .checks import check_kind, check_number, short_repr
from .roots import root_to_last_bit


@dataclass(frozen=True)
class Prestress:
    """Non-dimensional pre-stress tau(x), with nucleation at x = 0.

    The profile is ``level(x) + (peak - level(x)) exp(-x^2 / 2 width^2) + bumps``, where ``level`` is ``left`` for
    x < 0 and ``right`` for x >= 0 until a step replaces it.

    Parameters
    ----------
    left, right : levels far to the left and right (tau_{0,l} and tau_{0,r}), < 1
    width : standard deviation W of the Gaussian (units of H), > 0
    peak : value at x = 0; at 1 the block there is released at t = 0, below 1 nothing moves
    steps : tuple of (position, level): beyond the position (away from x = 0) the side's level becomes this
    bumps : tuple of (centre, amplitude, width): Gaussians added, as a barrier (amplitude < 0), an asperity, or a second
        nucleation point

    Raises ValueError: if a value is not a finite number, a width is not positive, or a step stands at x = 0.

    Source: section III of the paper; steps and bumps are this project's addition.
    """

    left: float
    right: float
    width: float = 1.0
    peak: float = 1.0
    steps: tuple[tuple[float, float], ...] = ()
    bumps: tuple[tuple[float, float, float], ...] = ()

    def __post_init__(self) -> None:
        for name in ("left", "right"):
            # A level at the threshold would release block after block at t = 0, without end.
            check_number(f"prestress.{name}", getattr(self, name), below=1.0)
        check_number("prestress.peak", self.peak)
        check_number("prestress.width", self.width, above=0.0)
        for name in ("left", "right", "width", "peak"):
            object.__setattr__(self, name, float(getattr(self, name)))
        for name, parts in (
            ("steps", ("position", "level")),
            ("bumps", ("centre", "amplitude", "width")),
        ):
            object.__setattr__(self, name, _tuples(f"prestress.{name}", getattr(self, name), parts))
        for position, level in self.steps:
            check_number("prestress.steps level", level, below=1.0)
            if position == 0.0:
                raise ValueError(
                    "prestress.steps: position is 0.0; allowed: any other number (see left, right)"
                )
        positions = [position for position, _ in self.steps]
        if twice := next(
            (position for position in positions if positions.count(position) > 1), None
        ):
            raise ValueError(
                f"prestress.steps: position {twice} twice; allowed: different positions"
            )
        for *_, width in self.bumps:
            check_number("prestress.bumps width", width, above=0.0)

    @property
    def symmetric(self) -> bool:
        """Whether tau(-x) = tau(x), so that half the lattice is enough."""
        parts = {*self.steps, *self.bumps}
        return self.left == self.right and parts == {
            (-position, *rest) for position, *rest in parts
        }

    def level(self, x: np.ndarray | float) -> np.ndarray:
        """Side level at positions x, steps included, the Gaussian and the bumps not."""
        x = np.asarray(x, dtype=float)
        level = np.where(x < 0.0, self.left, self.right)
        for position, value in sorted(self.steps, key=lambda step: abs(step[0])):
            level = np.where(x * math.copysign(1.0, position) >= abs(position), value, level)
        return level

    @cached_property
    def intervals(self) -> list[tuple[float, float, float]]:
        """Where the side level is constant, from left to right: left end, right end, level."""
        jumps = sorted({0.0, *(position for position, _ in self.steps)})
        inside = [jumps[0] - 1.0, *(0.5 * (a + b) for a, b in pairwise(jumps)), jumps[-1] + 1.0]
        ends = pairwise([-math.inf, *jumps, math.inf])
        return [
            (*pair, level)
            for pair, level in zip(ends, self.level(np.array(inside)).tolist(), strict=True)
        ]

    def __call__(self, x: np.ndarray | float) -> np.ndarray:
        """Pre-stress at positions x (units of H), exactly ``peak`` at x = 0 when there are no bumps."""
        x = np.asarray(x, dtype=float)
        # peak + (level - peak)(1 - exp): no cancellation near x = 0, where the release threshold is met.
        tau = self.peak + (self.level(x) - self.peak) * -np.expm1(-0.5 * (x / self.width) ** 2)
        # Bumps at equal distances first to each other, so that a mirrored profile is mirrored to the last bit.
        parts = [(abs(c), a, w, a * np.exp(-0.5 * ((x - c) / w) ** 2)) for c, a, w in self.bumps]
        for _, group in groupby(
            sorted(parts, key=lambda part: part[:3]), key=lambda part: part[:3]
        ):
            tau = tau + sum(values for *_, values in group)
        # The far tail of a bump leaves the peak within rounding of the threshold, which it is meant to meet.
        return (
            np.where(np.abs(tau - 1.0) <= 4.0 * sys.float_info.epsilon, 1.0, tau)
            if self.bumps
            else tau
        )

    def integral(self, lower: float, upper: float) -> float:
        """Integral of tau from ``lower`` to ``upper``, in closed form between the steps.

        Raises ValueError: if an end is not a finite number.
        """
        check_number("lower", lower)
        check_number("upper", upper)
        low, high = min(lower, upper), max(lower, upper)
        total = 0.0
        for left, right, level in self.intervals:
            a, b = max(left, low), min(right, high)
            if a < b:
                total += level * (b - a) + (self.peak - level) * _gaussian_area(
                    a, b, 0.0, self.width
                )
        for centre, amplitude, width in self.bumps:
            total += amplitude * _gaussian_area(low, high, centre, width)
        return total if upper >= lower else -total


def prestress_from(attributes: Mapping) -> Prestress:
    """The pre-stress of a run, from its attributes.

    Raises ValueError if a value is none that `Scene.attributes` writes, KeyError if one is missing.
    """
    left, right, width, peak = (attributes[name] for name in ("left", "right", "width", "peak"))
    text = attributes["steps_and_bumps"]
    try:
        more = json.loads(text)
        steps, bumps = more["steps"], more["bumps"]
    except (TypeError, ValueError, LookupError):
        allowed = "a JSON object of steps and bumps"
        raise ValueError(f"steps_and_bumps: {short_repr(text)}; allowed: {allowed}") from None
    return Prestress(left, right, width, peak, steps, bumps)


def prestress_balance_position(prestress: Prestress) -> float:
    """x_minus < 0, where the integral of the pre-stress from x_minus to infinity vanishes.

    Raises ValueError: if its level is not 0 far to the right and negative far to the left; ArithmeticError: if none
    is found, or numbers are too large to compute with. Source: equation (11) of the paper, section III C.
    """
    check_kind("prestress", prestress, Prestress)
    return _balance_position(prestress)


@lru_cache(maxsize=1024)
def _balance_position(prestress: Prestress) -> float:
    # Beyond here the profile is its side levels to rounding.
    reaches = [(centre, 40.0 * width) for centre, _, width in prestress.bumps]
    reaches += [(position, prestress.width) for position, _ in prestress.steps]
    far = max([40.0 * prestress.width, *(abs(x) + width for x, width in reaches)])
    right, left = float(prestress.level(np.asarray(far))), float(prestress.level(np.asarray(-far)))
    if right != 0.0:
        raise ValueError(
            f"prestress.right: {right!r}; allowed: 0, or the balance integral is not finite"
        )
    if left >= 0.0:
        raise ValueError(
            f"prestress.left: {left!r}; allowed: < 0, or the pre-stress is never balanced"
        )
    lower, upper = -far, 0.0
    while prestress.integral(lower, far) > 0.0:
        lower *= 2.0
    if not prestress.integral(lower, far) <= 0.0 <= prestress.integral(upper, far):
        raise ArithmeticError("the pre-stress has no balance at x < 0 that can be computed")
    return root_to_last_bit(lambda x: prestress.integral(x, far), lower, upper)


def _gaussian_area(lower: float, upper: float, centre: float, width: float) -> float:
    a, b = ((x - centre) / (math.sqrt(2.0) * width) for x in (lower, upper))
    scale = width * math.sqrt(0.5 * math.pi)
    # On one side of the centre the tails are taken, which do not cancel.
    if a > 0.0:
        return scale * (math.erfc(a) - math.erfc(b))
    if b < 0.0:
        return scale * (math.erfc(-b) - math.erfc(-a))
    return scale * (math.erf(b) - math.erf(a))


def _tuples(key: str, rows: Any, names: tuple[str, ...]) -> tuple[tuple[float, ...], ...]:
    allowed = f"a list of [{', '.join(names)}]"
    many = hasattr(rows, "__iter__") and getattr(rows, "ndim", 1) != 0
    if isinstance(rows, str | bytes | Mapping) or not many:
        raise ValueError(f"{key}: {short_repr(rows)}; allowed: {allowed}")
    out = []
    for row in rows:
        if (
            not hasattr(row, "__len__")
            or len(row) != len(names)
            or not all(isinstance(v, Real) for v in row)
        ):
            raise ValueError(f"{key}: {short_repr(row)}; allowed: {allowed}, numbers")
        for name, value in zip(names, row, strict=True):
            check_number(f"{key} {name}", value)
        out.append(tuple(float(value) for value in row))
    return tuple(out)
