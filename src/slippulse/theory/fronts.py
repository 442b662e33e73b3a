"""Both fronts of one nucleation point at x = 0, and the slip velocity behind them."""

import numpy as np

from ..model.checks import as_numbers, check_choice, check_kind, check_number
from ..model.prestress import Prestress
from .curve import Curve, Point, seen_from
from .domains import broadcast_numbers, check_domains
from .fast_front import FastFront
from .prestress_pieces import nucleations
from .riemann import Past


class Fronts:
    """Arrival times T(x) of both fronts of one nucleation point, while they outrun the waves.

    Parameters
    ----------
    prestress : Prestress with tau(0) = 1 and one nucleation point
    damping_ratio, release : beta/dx, from 0 to 1e6; "total" or "elastic"
    reach : float, distance from x = 0 up to which times are wanted (units of H), >= 1e-9
    gamma : float, elasticity ratio, >= 0, whose waves the panels resolve

    Attribute ends: by side, -1 or 1, the distance where tau turns negative; inf beyond ``reach``.
    Raises ValueError: outside these ranges; if the profile does not nucleate at x = 0 alone; or if
    a side needs more than 20000 panels.

    Examples
    --------
    >>> round(float(Fronts(Prestress(0.5, 0.5), 0.0, "total", 5.0).arrival(2.0)), 3)
    1.06
    """

    def __init__(
        self,
        prestress: Prestress,
        damping_ratio: float,
        release: str,
        reach: float,
        gamma: float = 0.0,
    ) -> None:
        law = FastFront(prestress, gamma, damping_ratio, release)
        check_domains(reach=reach)
        check_number("prestress at x = 0", float(prestress(0.0)), at_least=1.0)
        starts = nucleations(prestress)
        if len(starts) > 1 or starts[0][0] != starts[0][1]:
            raise ValueError("prestress: reaches 1 away from x = 0; allowed: one nucleation point")
        start, reach = Point(0.0, 0.0), float(reach)
        right, right_end = law.rightwards(start, reach, np.inf)
        left, left_end = right, right_end
        if not prestress.symmetric:
            left, left_end = law.mirrored().rightwards(start, reach, np.inf)
        ends = np.array([left_end.x, right_end.x])
        ends[ends >= reach] = np.inf
        self.ends = dict(zip((-1.0, 1.0), ends.tolist(), strict=True))
        self.curve = Curve(seen_from(-1.0, left) + right)

    def arrival(self, x) -> np.ndarray:
        """T(x): when the front reaches x, an array; NaN beyond where it outruns the waves.

        Parameters
        ----------
        x : float or array, positions, finite

        Returns
        -------
        array, NaN beyond where the front outruns the waves
        """
        return self.curve.arrival(as_numbers("x", x))

    def reached(self, time: float, sign: float) -> float:
        """Distance from x = 0 of the right (sign +1) or left (-1) front, before its ``reach``.

        Parameters
        ----------
        time, sign : a time >= 0, before the front is at ``reach``; +1 (right) or -1 (left)

        Returns
        -------
        float, >= 0
        """
        check_choice("sign", sign, (-1, 1))
        last = 0 if sign < 0.0 else -1
        check_number("time", time, at_least=0.0, below=float(self.curve.edge_times[last]))
        return abs(self.curve.front_at(time, 0.0, sign))


def slip_velocity(fronts: Fronts, gamma, y, time):
    """du/dt at points before anything sticks, 0 where no front has been.

    Raises ValueError: outside these ranges, or if the past of a point leaves the part that outruns
    the waves. Source: Riemann's solution (`riemann`).

    Parameters
    ----------
    fronts : Fronts
    gamma : float or array, elasticity ratio, >= 0, whose waves the panels of the fronts resolve
    y, time : float or array, positions and times, finite; broadcast with gamma

    Returns
    -------
    float or array, 0 where no front has been
    """
    check_kind("fronts", fronts, Fronts)
    domains = {"gamma": {"at_least": 0.0}}
    stiffness, y, time = broadcast_numbers(domains, gamma=gamma, y=y, time=time)
    released = fronts.curve.arrival(y) < time
    past = Past(fronts.curve, stiffness[released], y[released], time[released])
    if not np.all(past.left.known & past.right.known):
        allowed = "earlier, its past leaves the part that outruns the waves"
        raise ValueError(f"time: {time!r}; allowed: {allowed}")
    out = np.zeros(released.shape)
    out[released] = past.slip_velocity()
    if not np.isfinite(out).all():
        allowed = "numbers whose waves the panels of the fronts resolve"
        raise ValueError(f"gamma: {gamma!r}; allowed: {allowed}")
    return out if out.ndim else float(out)
