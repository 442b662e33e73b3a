"""The front speed that belongs to a pre-stress: roots of the Wiener-Hopf condition, one by one or many at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from .wiener_hopf import log_prestress

# ln(v - 1) where v is 1 to all digits, and beyond any speed in the domain.
SLOWEST, FASTEST = -80.0, 280.0
# Elements solved at once: bounds memory.
CHUNK = 128


def log_excess(tau: np.ndarray, ratio: np.ndarray, release: str) -> np.ndarray:
    """ln(v - 1) for 1-d arrays, b > 0."""
    # Neighbours in the order of the speed share a contour.
    guess = first_guess(tau, ratio, release)
    order = np.argsort(guess)
    out = np.empty(tau.size)
    for start in range(0, tau.size, CHUNK):
        part = order[start : start + CHUNK]

        def levels(x: np.ndarray, alive: np.ndarray, part: np.ndarray = part) -> np.ndarray:
            return log_prestress(np.exp(x), ratio[part][alive], 0.0, release)

        out[part] = root(levels, tau[part], np.full(part.size, SLOWEST), guess[part])
    return out


def _logit(level: np.ndarray) -> np.ndarray:
    """ln(tau/(1 - tau)) from ln tau; beyond the floating range below 1 the stress is faster than any target."""
    return level - np.log(np.maximum(-np.expm1(level), 1e-17))


def slowest(tau: np.ndarray, ratio: np.ndarray | float, release: str) -> np.ndarray:
    """1/v of fronts with v >> b: -ln tau = b/v + 1/(2 v^2) ("total") or 1/(2 v^2) ("elastic"), up to 1/v^3."""
    level = -np.log(tau)
    damping = np.asarray(ratio) if release == "total" else 0.0
    return 2.0 * level / np.maximum(damping + np.sqrt(damping**2 + 2.0 * level), 1e-300)


def in_chunks(excess: np.ndarray, ratio: np.ndarray, release: str) -> np.ndarray:
    starts = range(0, excess.size, CHUNK)
    return np.concatenate(
        [log_prestress(excess[i : i + CHUNK], ratio[i : i + CHUNK], 0.0, release) for i in starts]
    )


def first_guess(tau: np.ndarray, ratio: np.ndarray, release: str) -> np.ndarray:
    """ln(v - 1) from the limits b = 0, and b = 1 ("total") or b -> infinity ("elastic"), and from strong damping."""
    rest = 1.0 - tau
    undamped = np.log(tau) * 2.0 - np.log(rest * (1.0 + tau) + np.sqrt(rest * (1.0 + tau)))
    if release == "elastic":
        damped = np.log(tau) - np.log(rest + np.sqrt(rest))
        return np.where(ratio < 0.2, undamped + 0.5 * ratio, damped - 1.0 / (1.0 + 2.0 * ratio))
    weight = np.minimum(ratio, 1.0)
    return (1.0 - weight) * undamped + weight * (np.log(tau / rest) + np.log(np.maximum(ratio, 1.0)))


def root(
    levels: Callable[[np.ndarray, np.ndarray], np.ndarray],
    tau: np.ndarray,
    low: np.ndarray,
    guess: np.ndarray,
) -> np.ndarray:
    """x = ln(v - 1) where the pre-stress is tau, by secants in ln(tau/(1 - tau)), which is nearly linear in x.

    Monotone in x, hence bracketed: a secant that leaves the bracket is replaced by its middle.
    """
    low, high = low.copy(), np.full(tau.size, FASTEST)
    target = np.log(tau) - np.log1p(-tau)

    def mismatch(x: np.ndarray, alive: np.ndarray) -> np.ndarray:
        return _logit(levels(x, alive)) - target[alive]

    alive = np.arange(tau.size)
    x = np.clip(guess, low + 0.1, high - 1.0)
    before, value_before = x.copy(), mismatch(x, alive)
    x = np.clip(x - np.clip(value_before, -2.0, 2.0), low, high)
    for _ in range(200):
        value = mismatch(x[alive], alive)
        high[alive] = np.where(value > 0.0, np.minimum(high[alive], x[alive]), high[alive])
        low[alive] = np.where(value < 0.0, np.maximum(low[alive], x[alive]), low[alive])
        change = value - value_before[alive]
        step = np.where(
            change != 0.0, -value * (x[alive] - before[alive]) / np.where(change != 0.0, change, 1.0), 0.0
        )
        following = x[alive] + step
        outside = (following <= low[alive]) | (following >= high[alive])
        # A secant's error is the product of the last two, up to a factor of order 1.
        last = np.abs(x[alive] - before[alive])
        tiny = np.abs(step) * np.minimum(last, 1.0) <= 1e-15 * (1.0 + np.abs(x[alive]))
        following = np.where(outside & ~tiny, 0.5 * (low[alive] + high[alive]), following)
        before[alive], value_before[alive], x[alive] = x[alive], value, following
        narrow = high[alive] - low[alive] <= 1e-13 * (1.0 + np.abs(x[alive]))
        alive = alive[~(tiny | narrow | (value == 0.0))]
        if alive.size == 0:
            return x
    raise ArithmeticError(f"the front speed did not converge at tau0 = {tau[alive[0]]!r}")
