"""The limit on friction that decreases with slip rate."""

import math


def check_runaway(gamma: float, alpha: float, key: str = "rate_strengthening") -> None:
    """Raise ValueError if friction alpha v is so negative that slip would grow without limit.

    Uniform slip u obeys d2u/dt2 = tau - gamma u - alpha du/dt. If alpha <= -2 sqrt(gamma), its
    velocity never decreases.

    gamma : elasticity ratio, which is the stiffness of the leaf springs
    alpha : friction per unit slip velocity
    key : name of alpha in the message
    """
    if alpha < 0.0 and alpha * alpha >= 4.0 * gamma:
        bound = f"> -2 sqrt(gamma) = {-2.0 * math.sqrt(gamma):.6g}"
        allowed = bound if gamma else ">= 0 without leaf springs"
        raise ValueError(
            f"{key}: {alpha!r}; allowed: {allowed}, since otherwise slip grows without limit"
        )
