"""The limit on friction that decreases with slip rate."""

import math


def check_runaway(gamma: float, alpha: float, key: str = "rate_strengthening") -> None:
    """Raise ValueError if alpha is so negative that uniform slip would grow without limit.

    Uniform slip obeys d2u/dt2 = tau - gamma u - alpha du/dt. Where alpha <= -2 sqrt(gamma), its
    velocity never decreases.
    """
    if alpha < 0.0 and alpha * alpha >= 4.0 * gamma:
        bound = f"> -2 sqrt(gamma) = {-2.0 * math.sqrt(gamma):.6g}"
        allowed = bound if gamma else ">= 0 without leaf springs"
        raise ValueError(
            f"{key}: {alpha!r}; allowed: {allowed}, since otherwise slip grows without limit"
        )
