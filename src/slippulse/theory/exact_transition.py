"""The crack-pulse transition under leaf springs, and what it needs: the fronts of one nucleation point at x = 0."""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from ..model.checks import as_numbers, check_choice, check_kind, check_number
from ..model.prestress import Prestress
from .curve import Curve, seen
from .domains import broadcast_numbers, check_domains
from .front_speeds import front_speed
from .fronts import NARROWEST, FrontLaw, nucleations, straight_panel
from .part import Part
from .riemann import Past

# Half the panels behind a uniform front that hardly outruns the waves.
FARTHEST = 10_000


class Fronts:
    """Arrival times T(x) of the fronts that outrun the waves, on both sides of one nucleation point at x = 0.

    Parameters
    ----------
    prestress : a profile with tau(0) = 1 and one nucleation point
    damping_ratio, release : beta/dx, from 0 to 1e6; "total" or "elastic"
    reach : how far from x = 0 times are wanted (units of H), >= 1e-9
    gamma : elasticity ratio, >= 0, whose waves the panels resolve

    Attribute ends: by side, -1 or 1, the distance where tau turns negative and the front slow; inf beyond ``reach``.
    Raises ValueError: outside these ranges; if the profile does not nucleate at x = 0 alone; or if a side needs more
    than 20000 panels.
    """

    def __init__(
        self,
        prestress: Prestress,
        damping_ratio: float,
        release: str,
        reach: float,
        gamma: float = 0.0,
    ) -> None:
        law = FrontLaw(prestress, gamma, damping_ratio, release)
        check_number("reach", reach, at_least=NARROWEST)
        check_number("prestress at x = 0", float(prestress(0.0)), at_least=1.0)
        starts = nucleations(prestress)
        if len(starts) > 1 or starts[0][0] != starts[0][1]:
            raise ValueError("prestress: reaches 1 away from x = 0; allowed: one nucleation point")
        right, end, _ = law.rightwards(0.0, 0.0, float(reach), np.inf)
        left, start = right, end
        if not prestress.symmetric:
            left, start, _ = law.mirrored().rightwards(0.0, 0.0, float(reach), np.inf)
        self.ends = {side: x if x < reach else np.inf for side, x in ((-1.0, start), (1.0, end))}
        self.curve = Curve(seen(left, -1.0) + right)

    def arrival(self, x) -> np.ndarray:
        """T(x): when the front reaches x (finite); NaN beyond where it outruns the waves."""
        return self.curve.arrival(as_numbers("x", x))

    def reached(self, time: float, sign: float) -> float:
        """How far from x = 0 the front on one side (+1 right, -1 left) is at a time >= 0.

        Raises ValueError: if it has gone as far as was asked for by then.
        """
        check_choice("sign", sign, (-1, 1))
        last = 0 if sign < 0.0 else -1
        check_number("time", time, at_least=0.0, below=float(self.curve.edge_times[last]))
        return abs(self.curve.front_at(time, 0.0, sign))


def slip_velocity(fronts: Fronts, gamma, y, time):
    """du/dt at points behind the fronts and before anything sticks; a float, or an array where the others broadcast.

    gamma : elasticity ratio, >= 0, whose waves the panels of the fronts must resolve; 0 under a stress boundary
    y, time : the points, finite; 0 where no front has been

    Raises ValueError: outside these ranges, or if a point's past leaves the part that outruns the waves.
    Source: Riemann's solution (`riemann`).
    """
    check_kind("fronts", fronts, Fronts)
    stiffness, y, time = broadcast_numbers(
        {"gamma": {"at_least": 0.0}}, gamma=gamma, y=y, time=time
    )
    released = fronts.curve.arrival(y) < time
    past = Past(fronts.curve, stiffness[released], y[released], time[released])
    if not np.all(past.left.known & past.right.known):
        raise ValueError(
            f"time: {time!r}; allowed: earlier, its past leaves the part that outruns the waves"
        )
    out = np.zeros(released.shape)
    out[released] = past.slip_velocity()
    if not np.isfinite(out).all():
        raise ValueError(
            f"gamma: {gamma!r}; allowed: numbers whose waves the panels of the fronts resolve"
        )
    return out if out.ndim else float(out)


class ExactTransition(NamedTuple):
    """When the first block sticks (Gamma = 1) and how far apart the fronts are then."""

    time: float
    length: float


def exact_transition_displacement(
    prestress: Prestress, gamma: float, damping_ratio: float = 0.0, release: str = "total"
) -> ExactTransition:
    """T_trans and L_trans of a symmetric scene under a displacement boundary, in the continuum limit.

    Parameters
    ----------
    prestress, gamma : a symmetric profile, tau(0) = 1, positive everywhere; elasticity ratio, > 0
    damping_ratio, release : beta/dx, from 0 to 1e6; "total" or "elastic"

    Raises ValueError: outside these ranges; if the profile nucleates elsewhere too; or if a front needs more than
    20000 panels: gamma times the square of the width from 1e-17 to 1e6 is safe.
    Source: the first zero of du/dt at x = 0; symmetric scenes stick there first. For others, `Rupture`.
    """
    check_kind("prestress", prestress, Prestress)
    check_domains(gamma=gamma)
    level = float(prestress.level(np.asarray(1e300)))
    if not prestress.symmetric or level <= 0.0:
        raise ValueError(
            "prestress: not symmetric and positive; allowed: equal levels > 0 on both sides"
        )
    gamma = float(gamma)
    period = float(np.pi / np.sqrt(gamma))
    # The past of (0, t) begins at x + T(x) = t, so x < t.
    fronts = Fronts(prestress, damping_ratio, release, 2.5 * period, gamma)
    stick = float(Part(fronts.curve, gamma, 2.0 * period).scan(np.zeros(1))[0])
    if not stick < fronts.curve.edge_times[-1]:
        reach = float(front_speed(level, damping_ratio, release)) * stick + 20.0 * prestress.width
        fronts = Fronts(prestress, damping_ratio, release, reach, gamma)
    return ExactTransition(stick, 2.0 * fronts.reached(stick, 1.0))


def uniform_transition_time(
    tau0: float, gamma: float, damping_ratio: float = 0.0, release: str = "total"
) -> float:
    """T_trans in uniform pre-stress, nucleated at one point; parameters as of `lattice_front_speed`.

    Raises ValueError: outside the domain.
    Source: the first zero of du/dt at x = 0 behind the fronts T(x) = |x|/v: with q = sqrt(gamma) t/(1 + 1/v) it is
    that of Int_0^q J0( sqrt((w q + q - w s)^2 - s^2) ) ds, w = 1/v, and depends on v alone.
    """
    check_domains(tau0=tau0, gamma=gamma, damping_ratio=damping_ratio)
    rate = 1.0 / float(front_speed(tau0, damping_ratio, release))
    # What is 0 in the velocity, a factor of it does not change.
    tau = max(tau0, 1e-9)
    # Beyond where its waves come from, a slow front need not be known.
    reach = 12.0 / max(1.0 - rate**2, 12.0 / FARTHEST)
    edges = np.linspace(-reach, reach, 2 * int(np.ceil(reach)) + 1)
    curve = Curve(
        [straight_panel(a, b, np.copysign(rate, a + b), tau) for a, b in pairwise(edges.tolist())]
    )
    return float(Part(curve, 1.0, 10.0).scan(np.zeros(1))[0]) / float(np.sqrt(float(gamma)))
