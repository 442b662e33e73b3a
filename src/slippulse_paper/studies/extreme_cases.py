"""Define the cases of the study of extremes: ruptures with one parameter at an extreme value.

In each case one measured quantity is compared with its exact value. The case also states the
verdict that it should get. A function here yields the cases with extreme values of one parameter.
"""

import math
from collections.abc import Iterator
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

# Parameters that a case has unless it sets them itself.
LEVEL = 0.5
GAMMA = 0.65
DAMPING_RATIO = 0.1
# Order of the Taylor steps, for which the time step is chosen. It is the default of a Scene.
ORDER = 4
# Without leaf springs the left front never covers its whole path. Its transition time is the time
# at which it has covered this fraction.
COVERED_FRACTION = 0.95
# With this distance between two nucleations, the fronts are steady when they meet.
NUCLEATION_DISTANCE = 20.0
# A pulse is steady when it reaches a barrier with this centre and width.
BARRIER_CENTRE = 25.0
BARRIER_WIDTH = 2.0
# Verdicts that a case may be expected to get.
RIGHT = "right"
FLAGGED = "flagged"
REFUSED = "refused"
STOPPED = "stopped"
NOT_OFFERED = "not offered"
# The type checker must not see that parameters of this type are no Python floats.
SINGLE_PRECISION: Any = np.float32
# Duration, divided by the exact transition time, of a run that measures the transition.
JUST_LONG_ENOUGH = 1.02


@dataclass(frozen=True)
class Case:
    """The parameters of a rupture, the quantity that is compared, and the expected verdict.

    family : name of the parameter or property that has an extreme value
    label : the extreme value, in words or symbols
    duration : in units of `exact_time`
    level : pre-stress on both sides; without leaf springs (gamma = 0) it is 0 on the right
    width, peak : of the Gaussian of the pre-stress at x = 0
    bumps : position, height and width of each additional Gaussian of the pre-stress
    damping_sign : 1, or -1 for the sign that the paper prints
    scene_parameters : further arguments of Scene
    """

    family: str
    label: str
    quantity: str
    expected_verdict: str
    dx: float
    duration: float
    level: float = LEVEL
    width: float = 1.0
    gamma: float = GAMMA
    damping_ratio: float = DAMPING_RATIO
    peak: float = 1.0
    bumps: tuple[tuple[float, float, float], ...] = ()
    damping_sign: int = 1
    scene_parameters: dict[str, Any] = field(default_factory=dict)

    def exact_time(self) -> float:
        """Return the exact time of the event that the case measures; 1 if it measures no event.

        The event is a transition, or the meeting of two fronts.
        """
        symmetric = Prestress(self.level, self.level, self.width)
        if self.family == "two nucleations":
            # The fronts of equal nucleations meet halfway between them.
            fronts = fast_fronts(symmetric, self.damping_ratio, "total", reach=NUCLEATION_DISTANCE)
            return float(fronts.arrival(0.5 * NUCLEATION_DISTANCE))
        if self.quantity != "T_trans":
            return 1.0
        # Without leaf springs the transition is the arrest of the left front.
        if self.gamma == 0.0:
            crack = ArrestingCrack(Prestress(self.level, 0.0, self.width), self.damping_ratio)
            return crack.transition(COVERED_FRACTION).time
        return exact_transition_displacement(symmetric, self.gamma, self.damping_ratio).time

    def expected(self) -> float:
        """Return the value that the quantity should have; NaN if the case is refused or stopped.

        The value is 0 for quantities that are errors, drifts, or counts of events that should not
        happen.
        """
        if self.expected_verdict in (REFUSED, STOPPED):
            return math.nan
        if self.quantity in ("T_trans", "meeting time"):
            return self.exact_time()
        if self.quantity == "slip":
            # Some cases have dx and gamma in single precision. The slip should not depend on this.
            in_double_precision = replace(self, dx=float(self.dx), gamma=float(self.gamma))
            return float(solve_on_lattice(in_double_precision.scene()).slip.max())
        if self.quantity not in ("front speed", "final slip"):
            return 0.0
        if self.family == "gamma":
            # These cases are undamped, and their speed depends on gamma dx^2. The speed is NaN if
            # no front is faster than the waves.
            return value_or_nan(lambda: lattice_front_speed(self.level, self.gamma, self.dx))
        pulse = steady_pulse(
            self.level,
            self.gamma,
            beta=self.damping_ratio * self.dx,
            damping_ratio=self.damping_ratio,
            release=self.scene_parameters.get("release", "total"),
        )
        return pulse.speed if self.quantity == "front speed" else pulse.slip

    def scene(self) -> Scene:
        """Return the scene, with a stable step unless the case sets another one.

        The duration of the case is in units of `exact_time`, and is converted here.

        Raises ValueError if the Scene refuses a parameter.
        """
        has_springs = self.gamma > 0.0
        right_level = self.level if has_springs else 0.0
        duration = self.duration * self.exact_time()
        if has_springs and self.quantity == "T_trans":
            # On a lattice the transition is late by the time in which waves cross a few blocks.
            duration += 4.0 * self.dx
        stable_step = choose_step("localised", ORDER, self.damping_ratio, self.gamma * self.dx**2)
        other_parameters = {"max_step": min(0.5, stable_step)} | self.scene_parameters
        return Scene(
            boundary="displacement" if has_springs else "stress",
            prestress=Prestress(self.level, right_level, self.width, self.peak, bumps=self.bumps),
            duration=duration,
            dx=self.dx,
            gamma=self.gamma,
            beta=self.damping_ratio * self.dx,
            **other_parameters,
        )


def levels_near_1() -> Iterator[Case]:
    """Yield cases of undamped fronts at 7 to 70 wave speeds; theory is exact at any spacing."""
    for level in (0.99, 0.999, 0.9999):
        yield Case(
            family="level near 1",
            label=f"tau_0 = {level:g}",
            quantity="front speed",
            expected_verdict=RIGHT,
            dx=0.1,
            duration=6.0,
            level=level,
            damping_ratio=0.0,
        )


def levels_near_0() -> Iterator[Case]:
    """Yield cases of narrow pulses. Those that the lattice does not resolve should be flagged.

    A pulse is resolved if it is many blocks wide. Its width is proportional to the level. The
    nucleation is narrow, too, but at least one block wide.
    """
    for level, dx, duration, width, expected_verdict in (
        (0.05, 0.8, 60.0, 0.8, FLAGGED),
        (0.05, 0.005, 60.0, 0.02, RIGHT),
        (0.02, 0.4, 60.0, 0.4, FLAGGED),
        (0.02, 0.002, 100.0, 0.02, RIGHT),
        (0.01, 0.4, 60.0, 0.4, FLAGGED),
        (0.01, 0.01, 60.0, 0.02, FLAGGED),
    ):
        yield Case(
            family="level near 0",
            label=f"tau_0 = {level:g}, dx = {dx:g}",
            quantity="final slip",
            expected_verdict=expected_verdict,
            dx=dx,
            duration=duration,
            level=level,
            width=width,
        )


def small_gammas() -> Iterator[Case]:
    """Yield cases of late transitions with large slip.

    At the smallest gamma the slip is 1e8, and the length scale of the leaf springs is 500 blocks.
    """
    for gamma, dx in ((1e-8, 20.0), (1e-4, 0.2)):
        yield Case(
            family="gamma",
            label=f"gamma = {gamma:g}",
            quantity="T_trans",
            expected_verdict=RIGHT,
            dx=dx,
            duration=JUST_LONG_ENOUGH,
            width=4.0 * dx,
            gamma=gamma,
        )


def large_gammas() -> Iterator[Case]:
    """Yield cases of front speeds at increasing gamma dx^2.

    Large values should be flagged, because the pulse is then only a few blocks wide. In the last
    two cases, no front on the lattice is faster than the waves.
    """
    dx = 0.01
    for gamma, expected_verdict in (
        (1.0, RIGHT),
        (100.0, RIGHT),
        (1000.0, FLAGGED),
        (6000.0, FLAGGED),
        (1e4, FLAGGED),
        (1e5, FLAGGED),
    ):
        yield Case(
            family="gamma",
            label=f"gamma dx^2 = {gamma * dx**2:g}",
            quantity="front speed",
            expected_verdict=expected_verdict,
            dx=dx,
            duration=40.0 / math.sqrt(gamma),
            width=0.1,
            gamma=gamma,
            damping_ratio=0.0,
        )


def strong_damping() -> Iterator[Case]:
    """Yield cases of front speeds under both release rules, at damping ratios from 0 to 100.

    Under the total rule strong damping makes fronts fast, so they settle early and the runs can be
    shorter. Under the elastic rule the theory holds only if the damped layer at the front is thin
    compared with the pulse, so cases of strong damping should be flagged.
    """
    for release, damping_ratio, duration, expected_verdict in (
        ("total", 0.0, 40.0, RIGHT),
        ("total", 1.0, 40.0 / 1.05, RIGHT),
        ("total", 10.0, 40.0 / 1.5, RIGHT),
        ("total", 100.0, 40.0 / 6.0, RIGHT),
        ("elastic", 1.0, 40.0, RIGHT),
        ("elastic", 10.0, 40.0, FLAGGED),
        ("elastic", 100.0, 40.0, FLAGGED),
    ):
        yield Case(
            family="damping",
            label=f"beta/dx = {damping_ratio:g}, {release}",
            quantity="front speed",
            expected_verdict=expected_verdict,
            dx=0.05,
            duration=duration,
            level=0.3,
            damping_ratio=damping_ratio,
            scene_parameters={"release": release},
        )


def extreme_spacings() -> Iterator[Case]:
    """Yield cases with spacings from one layer thickness to a thousandth of it.

    The largest spacing should be flagged, because the pulse is then only a few blocks wide.
    """
    for dx, quantity, duration, expected_verdict in (
        (1.0, "front speed", 60.0, FLAGGED),
        (0.3, "front speed", 60.0, RIGHT),
        (0.1, "front speed", 60.0, RIGHT),
        (0.01, "front speed", 60.0, RIGHT),
        (0.1, "T_trans", JUST_LONG_ENOUGH, RIGHT),
        (0.01, "T_trans", JUST_LONG_ENOUGH, RIGHT),
        (0.001, "T_trans", JUST_LONG_ENOUGH, RIGHT),
    ):
        yield Case(
            family="spacing",
            label=f"dx = {dx:g}",
            quantity=quantity,
            expected_verdict=expected_verdict,
            dx=dx,
            duration=duration,
        )


def extreme_nucleations() -> Iterator[Case]:
    """Yield cases with narrow Gaussians, and one with a width of 1000 layer thicknesses.

    A Gaussian that is narrower than a block is refused, because it could lie unseen between two
    blocks.
    """
    dx = 0.05
    for width_in_blocks, expected_verdict in ((0.5, REFUSED), (1.0, RIGHT), (2.0, RIGHT)):
        yield Case(
            family="nucleation",
            label=f"W = {width_in_blocks:g} dx",
            quantity="front speed",
            expected_verdict=expected_verdict,
            dx=dx,
            duration=20.0,
            width=width_in_blocks * dx,
        )
    yield Case(
        family="nucleation",
        label="W = 1000",
        quantity="T_trans",
        expected_verdict=RIGHT,
        dx=1.0,
        duration=JUST_LONG_ENOUGH,
        width=1000.0,
    )


def negative_levels() -> Iterator[Case]:
    """Yield cases of arrests of the left front in strongly negative pre-stress.

    A case should be flagged for one of three reasons. Blocks would slide back, because the
    pre-stress is too negative for the friction ratio r. The lattice is undamped, and its ringing
    stalls the front. Or the lattice is coarse, and the front is late.
    """
    for level, dx, friction_ratio, damping_ratio, expected_verdict in (
        (-1.0, 0.005, 5.0, 0.1, RIGHT),
        (-1.0, 0.01, 5.0, 0.0, FLAGGED),  # undamped
        (-10.0, 0.02, 5.0, 0.1, FLAGGED),  # coarse
        (-10.0, 0.004, 5.0, 0.1, RIGHT),
        (-30.0, 0.002, 5.0, 0.1, FLAGGED),  # blocks would slide back
        (-30.0, 0.002, 60.0, 0.1, RIGHT),
        (-100.0, 0.05, 60.0, 0.1, FLAGGED),  # coarse
        (-100.0, 0.001, 60.0, 0.1, RIGHT),
    ):
        yield Case(
            family="negative level",
            label=f"tau_l = {level:g}, dx {dx:g}, b {damping_ratio:g}, r {friction_ratio:g}",
            quantity="T_trans",
            expected_verdict=expected_verdict,
            dx=dx,
            # In units of the exact T_trans.
            duration=1.5,
            level=level,
            gamma=0.0,
            damping_ratio=damping_ratio,
            scene_parameters={"friction_ratio": friction_ratio},
        )


def long_duration() -> Iterator[Case]:
    """Yield cases of a steady pulse over a very long run, in which rounding errors add up."""
    for quantity in ("speed drift", "slip drift", "energy residual"):
        yield Case(
            family="duration",
            label="t = 100000",
            quantity=quantity,
            expected_verdict=RIGHT,
            dx=1.0,
            duration=1e5,
            width=2.0,
            gamma=0.01,
        )


def single_precision() -> Iterator[Case]:
    """Yield one case with parameters, and two with a lattice state, in single precision.

    The solver converts the parameters to double precision. It does not offer a lattice state in
    single precision.
    """
    yield Case(
        family="float32",
        label="parameters",
        quantity="slip",
        expected_verdict=RIGHT,
        dx=SINGLE_PRECISION(0.1),
        duration=5.0,
        gamma=SINGLE_PRECISION(GAMMA),
        damping_ratio=0.0,
    )
    for gamma in (0.01, 1e-3):
        yield Case(
            family="float32",
            label=f"state, gamma = {gamma:g}",
            quantity="velocity error",
            expected_verdict=NOT_OFFERED,
            dx=0.1,
            # This is shortly before the first stick.
            duration=0.9 * math.pi / math.sqrt(gamma),
            width=0.8,
            gamma=gamma,
            damping_ratio=0.0,
        )


def peaks_near_threshold() -> Iterator[Case]:
    """Yield cases with the peak of the pre-stress just below and just above the threshold, 1.

    A peak below the threshold releases no block. A peak just above it has the same effect as one
    that is exactly 1.
    """
    for label, quantity, peak in (
        ("1 - 1e-09", "releases", 1.0 - 1e-9),
        ("1 - 0.001", "releases", 1.0 - 1e-3),
        ("1 + 1e-09", "front speed", 1.0 + 1e-9),
        ("1 + 0.001", "front speed", 1.0 + 1e-3),
    ):
        yield Case(
            family="peak",
            label=label,
            quantity=quantity,
            expected_verdict=RIGHT,
            dx=0.05,
            duration=30.0,
            peak=peak,
        )


def two_nucleations() -> Iterator[Case]:
    """Yield cases of fronts that start at two equal peaks of the pre-stress.

    The fronts meet halfway between them, at the time when a single front would arrive there.
    """
    # Position, height and width of a bump that raises the level to 1, as the Gaussian at x = 0.
    second_peak = (NUCLEATION_DISTANCE, 1.0 - LEVEL, 1.0)
    # Durations are in units of the meeting time.
    for quantity, relative_duration in (("meeting time", 1.5), ("asymmetry", 3.0)):
        yield Case(
            family="two nucleations",
            label="20 apart",
            quantity=quantity,
            expected_verdict=RIGHT,
            dx=0.02,
            duration=relative_duration,
            bumps=(second_peak,),
        )


def barriers() -> Iterator[Case]:
    """Yield one case of a deep barrier, which stops the pulse, and one of a shallow barrier.

    The deep barrier should stop the pulse before its centre: the quantity "passes by", which is the
    distance that the pulse runs beyond the centre, is 0. The shallow barrier should not change the
    final front speed. The pulse is steady when it meets a barrier, of which there is one on each
    side.
    """
    for depth, quantity in ((1.5, "passes by"), (0.2, "front speed")):
        # Each barrier is a Gaussian with a position, a height and a width.
        right_barrier = (BARRIER_CENTRE, -depth, BARRIER_WIDTH)
        left_barrier = (-BARRIER_CENTRE, -depth, BARRIER_WIDTH)
        yield Case(
            family="barrier",
            label=f"depth {depth:g}",
            quantity=quantity,
            expected_verdict=RIGHT,
            dx=0.05,
            duration=60.0,
            bumps=(right_barrier, left_barrier),
        )


def unstable_runs() -> Iterator[Case]:
    """Yield cases that are unstable: damping with the printed sign, and too large time steps.

    With the printed sign, the shortest waves on the lattice grow. The steps are beyond the
    stability bound of each scheme.
    """
    yield Case(
        family="damping sign",
        label="as printed",
        quantity="slip",
        expected_verdict=STOPPED,
        dx=0.02,
        duration=10.0,
        damping_sign=-1,
    )
    for scheme in ("localised", "fixed_step"):
        yield Case(
            family="step",
            label=f"3 dx, {scheme}",
            quantity="front speed",
            expected_verdict=REFUSED,
            dx=0.1,
            duration=10.0,
            scene_parameters={"scheme": scheme, "max_step": 3.0},
        )


CASES = [
    *levels_near_1(),
    *levels_near_0(),
    *small_gammas(),
    *large_gammas(),
    *strong_damping(),
    *extreme_spacings(),
    *extreme_nucleations(),
    *negative_levels(),
    *long_duration(),
    *single_precision(),
    *peaks_near_threshold(),
    *two_nucleations(),
    *barriers(),
    *unstable_runs(),
]
