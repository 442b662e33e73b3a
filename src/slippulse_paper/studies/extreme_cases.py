"""The cases of the study of extremes: each takes one number of a common rupture to a limit."""

import math
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene
from slippulse.model.stability import choose_step
from slippulse.prediction.common import value_or_nan
from slippulse.solver.solution import solve_on_lattice
from slippulse.theory.arrest import ArrestingCrack
from slippulse.theory.exact_transition import exact_transition_displacement
from slippulse.theory.front_speeds_with_springs import lattice_front_speed
from slippulse.theory.pulse import steady_pulse
from slippulse.theory.two_fronts import fast_fronts

# A common rupture, of which one number at a time is extreme.
LEVEL, GAMMA = 0.5, 0.65
RATIO = 0.1
# The left front never covers all of its way: the time at which it has covered this is compared.
FRACTION = 0.95
# Two fronts are steady when they meet if their nucleations are this far apart.
APART = 20.0
SECOND = ((APART, 1.0 - LEVEL, 1.0),)
# A pulse is steady when it meets a barrier with this centre and width.
CENTRE, WIDTH = 25.0, 2.0
NOT_OFFERED = "not offered"
ELASTIC = {"release": "elastic"}
SINGLE: Any = np.float32


@dataclass(frozen=True)
class Case:
    """The common rupture with some of its numbers changed, the quantity compared, and its verdict.

    The duration is in units of `exact_time`. Without leaf springs (gamma = 0) the level on the
    right is 0. A Scene may refuse the numbers.
    """

    family: str
    where: str
    quantity: str
    should: str
    dx: float
    duration: float
    level: float = LEVEL
    width: float = 1.0
    gamma: float = GAMMA
    ratio: float = RATIO
    peak: float = 1.0
    bumps: tuple[tuple[float, float, float], ...] = ()
    damping_sign: int = 1
    other: dict[str, Any] = field(default_factory=dict)  # parameters of Scene

    def exact_time(self) -> float:
        """Exact time of the transition, or at which two fronts meet, or 1."""
        even = Prestress(self.level, self.level, self.width)
        if self.family == "two nucleations":
            return float(fast_fronts(even, self.ratio, "total", APART).arrival(0.5 * APART))
        if self.quantity != "T_trans":
            return 1.0
        if self.gamma == 0.0:
            crack = ArrestingCrack(Prestress(self.level, 0.0), self.ratio)
            return crack.transition(FRACTION).time
        return exact_transition_displacement(even, self.gamma, self.ratio).time

    def expected(self) -> float:
        """The exact value of the quantity; NaN where a case is refused or stopped."""
        if self.should in ("refused", "stopped"):
            return math.nan
        if self.quantity in ("T_trans", "meeting time"):
            return self.exact_time()
        if self.quantity == "slip":
            double = replace(self, dx=float(self.dx), gamma=float(self.gamma))
            return float(solve_on_lattice(double.scene()).slip.max())
        if self.quantity not in ("front speed", "final slip"):
            return 0.0
        if self.family == "gamma":
            return value_or_nan(lambda: lattice_front_speed(self.level, self.gamma, self.dx))
        law = {"damping_ratio": self.ratio, "release": self.other.get("release", "total")}
        pulse = steady_pulse(self.level, self.gamma, self.ratio * self.dx, **law)
        return pulse.speed if self.quantity == "front speed" else pulse.slip

    def scene(self) -> Scene:
        """The scene, with a stable step unless another is given."""
        held = self.gamma > 0.0
        right = self.level if held else 0.0
        profile = Prestress(self.level, right, self.width, self.peak, bumps=self.bumps)
        duration = self.duration * self.exact_time()
        if held and self.quantity == "T_trans":
            # The lattice is late by some of its blocks.
            duration += 4.0 * self.dx
        step = min(0.5, choose_step("localised", 4, self.ratio, self.gamma * self.dx**2))
        boundary = "displacement" if held else "stress"
        other = {"max_step": step} | self.other
        return Scene(
            boundary, profile, duration, self.dx, self.gamma, self.ratio * self.dx, **other
        )


def barrier(depth: float) -> tuple[tuple[float, float, float], ...]:
    """Bumps of negative pre-stress on both sides, which a steady pulse meets."""
    return (CENTRE, -depth, WIDTH), (-CENTRE, -depth, WIDTH)


# The numbers after the verdict are dx, duration, level and width.
CASES = (
    # Undamped fronts at 7 to 70 wave speeds are exact at any spacing.
    Case("level near 1", "tau_0 = 0.99", "front speed", "right", 0.1, 6, 0.99, ratio=0.0),
    Case("level near 1", "tau_0 = 0.999", "front speed", "right", 0.1, 6, 0.999, ratio=0.0),
    Case("level near 1", "tau_0 = 0.9999", "front speed", "right", 0.1, 6, 0.9999, ratio=0.0),
    # Some pulses are narrower than a block, or of fewer blocks than a Scene asks for.
    Case("level near 0", "tau_0 = 0.05, dx = 0.8", "final slip", "flagged", 0.8, 60, 0.05, 0.8),
    Case("level near 0", "tau_0 = 0.05, dx = 0.005", "final slip", "right", 0.005, 60, 0.05, 0.02),
    Case("level near 0", "tau_0 = 0.02, dx = 0.4", "final slip", "flagged", 0.4, 60, 0.02, 0.4),
    Case("level near 0", "tau_0 = 0.02, dx = 0.002", "final slip", "right", 0.002, 100, 0.02, 0.02),
    Case("level near 0", "tau_0 = 0.01, dx = 0.4", "final slip", "flagged", 0.4, 60, 0.01, 0.4),
    Case("level near 0", "tau_0 = 0.01, dx = 0.01", "final slip", "flagged", 0.01, 60, 0.01, 0.02),
    # Slip is 1e8 at the smallest gamma, with 500 blocks to the scale of the leaf springs.
    Case("gamma", "gamma = 1e-08", "T_trans", "right", 20.0, 1.02, width=80.0, gamma=1e-8),
    Case("gamma", "gamma = 0.0001", "T_trans", "right", 0.2, 1.02, width=0.8, gamma=1e-4),
    # Beyond the last but one gamma no front on the lattice is faster than the waves.
    *(
        Case("gamma", f"gamma dx^2 = {gamma * 0.01**2:g}", "front speed", should, 0.01,
             40 / math.sqrt(gamma), width=0.1, gamma=gamma, ratio=0.0)
        for gamma, should in (
            (1.0, "right"), (100.0, "right"), (1000.0, "flagged"),
            (6000.0, "flagged"), (1e4, "flagged"), (1e5, "flagged"),
        )
    ),
    # Strong damping makes fronts under the total rule fast, so that they settle early. Under the
    # elastic rule the damped layer must be thin against the pulse.
    Case("damping", "beta/dx = 0, total", "front speed", "right", 0.05, 40, 0.3, ratio=0.0),
    Case("damping", "beta/dx = 1, total", "front speed", "right", 0.05, 40 / 1.05, 0.3, ratio=1.0),
    Case("damping", "beta/dx = 10, total", "front speed", "right", 0.05, 40 / 1.5, 0.3, ratio=10.0),
    Case("damping", "beta/dx = 100, total", "front speed", "right", 0.05, 40 / 6, 0.3, ratio=100.0),
    *(
        Case("damping", f"beta/dx = {ratio:g}, elastic", "front speed", should, 0.05, 40, 0.3,
             ratio=ratio, other=ELASTIC)
        for ratio, should in ((1.0, "right"), (10.0, "flagged"), (100.0, "flagged"))
    ),
    # Spacings go from one layer thickness to a thousandth.
    Case("spacing", "dx = 1", "front speed", "flagged", 1.0, 60),
    Case("spacing", "dx = 0.3", "front speed", "right", 0.3, 60),
    Case("spacing", "dx = 0.1", "front speed", "right", 0.1, 60),
    Case("spacing", "dx = 0.01", "front speed", "right", 0.01, 60),
    Case("spacing", "dx = 0.1", "T_trans", "right", 0.1, 1.02),
    Case("spacing", "dx = 0.01", "T_trans", "right", 0.01, 1.02),
    Case("spacing", "dx = 0.001", "T_trans", "right", 1e-3, 1.02),
    # A peak between two blocks cannot be seen.
    Case("nucleation", "W = 0.5 dx", "front speed", "refused", 0.05, 20, width=0.025),
    Case("nucleation", "W = 1 dx", "front speed", "right", 0.05, 20, width=0.05),
    Case("nucleation", "W = 2 dx", "front speed", "right", 0.05, 20, width=0.1),
    Case("nucleation", "W = 1000", "T_trans", "right", 1.0, 1.02, width=1000.0),
    # Fronts into negative pre-stress may slide in reverse from the friction ratio on. The lattice
    # stalls them where nothing damps its ringing, and late where it is coarse.
    *(
        Case("negative level", f"tau_l = {level:g}, dx {dx:g}, b {ratio:g}, r {friction:g}",
             "T_trans", should, dx, 1.5, level, gamma=0.0, ratio=ratio,
             other={"friction_ratio": friction})
        for level, dx, friction, ratio, should in (
            (-1.0, 0.005, 5.0, 0.1, "right"),
            (-1.0, 0.01, 5.0, 0.0, "flagged"),
            (-10.0, 0.02, 5.0, 0.1, "flagged"),
            (-10.0, 0.004, 5.0, 0.1, "right"),
            (-30.0, 0.002, 5.0, 0.1, "flagged"),
            (-30.0, 0.002, 60, 0.1, "right"),
            (-100.0, 0.05, 60, 0.1, "flagged"),
            (-100.0, 0.001, 60, 0.1, "right"),
        )
    ),
    # A steady pulse drifts by rounding over a very long run.
    Case("duration", "t = 100000", "speed drift", "right", 1.0, 1e5, width=2.0, gamma=0.01),
    Case("duration", "t = 100000", "slip drift", "right", 1.0, 1e5, width=2.0, gamma=0.01),
    Case("duration", "t = 100000", "energy residual", "right", 1.0, 1e5, width=2.0, gamma=0.01),
    # Parameters in single precision are computed with in double; such a state is not offered.
    Case("float32", "parameters", "slip", "right", SINGLE(0.1), 5, gamma=SINGLE(GAMMA), ratio=0.0),
    *(
        Case("float32", f"state, gamma = {gamma:g}", "velocity error", NOT_OFFERED, 0.1,
             0.9 * math.pi / math.sqrt(gamma), width=0.8, gamma=gamma, ratio=0.0)
        for gamma in (0.01, 1e-3)
    ),
    # A peak just below the threshold moves nothing; one just above it is as one at it.
    Case("peak", "1 - 1e-09", "releases", "right", 0.05, 30, peak=1.0 - 1e-9),
    Case("peak", "1 - 0.001", "releases", "right", 0.05, 30, peak=1.0 - 1e-3),
    Case("peak", "1 + 1e-09", "front speed", "right", 0.05, 30, peak=1.0 + 1e-9),
    Case("peak", "1 + 0.001", "front speed", "right", 0.05, 30, peak=1.0 + 1e-3),
    # Fronts of two equal peaks meet halfway when one of them takes to get there.
    Case("two nucleations", "20 apart", "meeting time", "right", 0.02, 1.5, bumps=SECOND),
    Case("two nucleations", "20 apart", "asymmetry", "right", 0.02, 3.0, bumps=SECOND),
    # A deep barrier stops the pulse, and a shallow one does not.
    Case("barrier", "depth 1.5", "passes by", "right", 0.05, 60, bumps=barrier(1.5)),
    Case("barrier", "depth 0.2", "front speed", "right", 0.05, 60, bumps=barrier(0.2)),
    # The damping term as the paper prints it feeds the grid modes.
    Case("damping sign", "as printed", "slip", "stopped", 0.02, 10, damping_sign=-1),
    # A step is beyond the stability bound of each scheme.
    Case("step", "3 dx, localised", "front speed", "refused", 0.1, 10, other={"max_step": 3.0}),
    Case("step", "3 dx, fixed_step", "front speed", "refused", 0.1, 10,
         other={"scheme": "fixed_step", "max_step": 3.0}),
)  # fmt: skip
