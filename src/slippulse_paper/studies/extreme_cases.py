"""Define the cases of the study of extremes: each takes one parameter of a rupture to a limit."""

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

# Parameters of the common rupture; each case changes one of them to an extreme value.
LEVEL, GAMMA = 0.5, 0.65
DAMPING_RATIO = 0.1
# The left front never covers its whole path, so the cases compare the time to cover this fraction.
COVERED_FRACTION = 0.95
# With this distance between two nucleations, the fronts are steady when they meet.
NUCLEATION_DISTANCE = 20.0
TWIN_NUCLEATION = ((NUCLEATION_DISTANCE, 1.0 - LEVEL, 1.0),)
# A pulse is steady when it reaches a barrier with this centre and width.
BARRIER_CENTRE, BARRIER_WIDTH = 25.0, 2.0
NOT_OFFERED = "not offered"
ELASTIC_RULE = {"release": "elastic"}
SINGLE_PRECISION: Any = np.float32


@dataclass(frozen=True)
class Case:
    """The common rupture with changed parameters, the quantity compared, and the expected verdict.

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
    ratio: float = DAMPING_RATIO
    peak: float = 1.0
    bumps: tuple[tuple[float, float, float], ...] = ()
    damping_sign: int = 1
    other: dict[str, Any] = field(default_factory=dict)  # parameters of Scene

    def exact_time(self) -> float:
        """Return the exact transition time, or the time at which two fronts meet, or else 1."""
        even = Prestress(self.level, self.level, self.width)
        if self.family == "two nucleations":
            return float(
                fast_fronts(even, self.ratio, "total", NUCLEATION_DISTANCE).arrival(
                    0.5 * NUCLEATION_DISTANCE
                )
            )
        if self.quantity != "T_trans":
            return 1.0
        if self.gamma == 0.0:
            crack = ArrestingCrack(Prestress(self.level, 0.0), self.ratio)
            return crack.transition(COVERED_FRACTION).time
        return exact_transition_displacement(even, self.gamma, self.ratio).time

    def expected(self) -> float:
        """Return the exact value of the quantity; NaN if the case is refused or stopped."""
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
        """Return the scene, with a stable step unless the case sets another one."""
        held = self.gamma > 0.0
        right = self.level if held else 0.0
        profile = Prestress(self.level, right, self.width, self.peak, bumps=self.bumps)
        duration = self.duration * self.exact_time()
        if held and self.quantity == "T_trans":
            # A lattice reaches the point a few blocks late.
            duration += 4.0 * self.dx
        step = min(0.5, choose_step("localised", 4, self.ratio, self.gamma * self.dx**2))
        boundary = "displacement" if held else "stress"
        other = {"max_step": step} | self.other
        return Scene(
            boundary, profile, duration, self.dx, self.gamma, self.ratio * self.dx, **other
        )


def barrier(depth: float) -> tuple[tuple[float, float, float], ...]:
    """Return bumps of negative pre-stress on both sides, which a steady pulse runs into."""
    return (BARRIER_CENTRE, -depth, BARRIER_WIDTH), (-BARRIER_CENTRE, -depth, BARRIER_WIDTH)


# The numbers after the verdict are dx, duration, level and width.
CASES = (
    # Undamped fronts at 7 to 70 wave speeds are exact at any spacing.
    Case("level near 1", "tau_0 = 0.99", "front speed", "right", 0.1, 6, 0.99, ratio=0.0),
    Case("level near 1", "tau_0 = 0.999", "front speed", "right", 0.1, 6, 0.999, ratio=0.0),
    Case("level near 1", "tau_0 = 0.9999", "front speed", "right", 0.1, 6, 0.9999, ratio=0.0),
    # Some pulses are narrower than a block, or have fewer blocks than a Scene requires.
    Case("level near 0", "tau_0 = 0.05, dx = 0.8", "final slip", "flagged", 0.8, 60, 0.05, 0.8),
    Case("level near 0", "tau_0 = 0.05, dx = 0.005", "final slip", "right", 0.005, 60, 0.05, 0.02),
    Case("level near 0", "tau_0 = 0.02, dx = 0.4", "final slip", "flagged", 0.4, 60, 0.02, 0.4),
    Case("level near 0", "tau_0 = 0.02, dx = 0.002", "final slip", "right", 0.002, 100, 0.02, 0.02),
    Case("level near 0", "tau_0 = 0.01, dx = 0.4", "final slip", "flagged", 0.4, 60, 0.01, 0.4),
    Case("level near 0", "tau_0 = 0.01, dx = 0.01", "final slip", "flagged", 0.01, 60, 0.01, 0.02),
    # At the smallest gamma the slip is 1e8, and the length scale of the leaf springs is 500 blocks.
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
    # elastic rule the damped layer must be thin compared with the pulse.
    Case("damping", "beta/dx = 0, total", "front speed", "right", 0.05, 40, 0.3, ratio=0.0),
    Case("damping", "beta/dx = 1, total", "front speed", "right", 0.05, 40 / 1.05, 0.3, ratio=1.0),
    Case("damping", "beta/dx = 10, total", "front speed", "right", 0.05, 40 / 1.5, 0.3, ratio=10.0),
    Case("damping", "beta/dx = 100, total", "front speed", "right", 0.05, 40 / 6, 0.3, ratio=100.0),
    *(
        Case("damping", f"beta/dx = {ratio:g}, elastic", "front speed", should, 0.05, 40, 0.3,
             ratio=ratio, other=ELASTIC_RULE)
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
    # In negative pre-stress beyond a limit set by the friction ratio, blocks would slide back.
    # Without damping the ringing of the lattice stalls such fronts, and coarse lattices are late.
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
    # Parameters in single precision are converted to double. Such a state is not offered.
    Case("float32", "parameters", "slip", "right", SINGLE_PRECISION(0.1), 5,
         gamma=SINGLE_PRECISION(GAMMA), ratio=0.0),
    *(
        Case("float32", f"state, gamma = {gamma:g}", "velocity error", NOT_OFFERED, 0.1,
             0.9 * math.pi / math.sqrt(gamma), width=0.8, gamma=gamma, ratio=0.0)
        for gamma in (0.01, 1e-3)
    ),
    # A peak just below the threshold releases nothing; one just above it acts like one at it.
    Case("peak", "1 - 1e-09", "releases", "right", 0.05, 30, peak=1.0 - 1e-9),
    Case("peak", "1 - 0.001", "releases", "right", 0.05, 30, peak=1.0 - 1e-3),
    Case("peak", "1 + 1e-09", "front speed", "right", 0.05, 30, peak=1.0 + 1e-9),
    Case("peak", "1 + 0.001", "front speed", "right", 0.05, 30, peak=1.0 + 1e-3),
    # Fronts from two equal peaks meet halfway, when a single front would arrive there.
    Case("two nucleations", "20 apart", "meeting time", "right", 0.02, 1.5, bumps=TWIN_NUCLEATION),
    Case("two nucleations", "20 apart", "asymmetry", "right", 0.02, 3.0, bumps=TWIN_NUCLEATION),
    # A deep barrier stops the pulse, and a shallow one does not.
    Case("barrier", "depth 1.5", "passes by", "right", 0.05, 60, bumps=barrier(1.5)),
    Case("barrier", "depth 0.2", "front speed", "right", 0.05, 60, bumps=barrier(0.2)),
    # The damping term with the printed sign makes grid modes grow.
    Case("damping sign", "as printed", "slip", "stopped", 0.02, 10, damping_sign=-1),
    # The step exceeds the stability bound of each scheme.
    Case("step", "3 dx, localised", "front speed", "refused", 0.1, 10, other={"max_step": 3.0}),
    Case("step", "3 dx, fixed_step", "front speed", "refused", 0.1, 10,
         other={"scheme": "fixed_step", "max_step": 3.0}),
)  # fmt: skip
