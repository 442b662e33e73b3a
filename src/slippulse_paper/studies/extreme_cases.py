"""Define the cases of the study of extremes: each takes one parameter of a rupture to a limit.

A case compares one measured quantity with its exact value, and states the verdict that it should
get. There is one function for each family of cases; a family takes the same parameter to a limit.
"""

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
LEVEL = 0.5
GAMMA = 0.65
DAMPING_RATIO = 0.1
# The left front never covers its whole path, so the cases compare the time to cover this fraction.
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
SINGLE_PRECISION: Any = np.float32
# Duration, in units of the exact time, of a run that measures when something happens.
JUST_LONG_ENOUGH = 1.02


@dataclass(frozen=True)
class Case:
    """The common rupture with changed parameters, and the quantity that is compared.

    The duration is in units of `exact_time`. Without leaf springs (gamma = 0) the level on the
    right is 0. A Scene may refuse the numbers.
    """

    family: str
    label: str  # the extreme value, in words or symbols
    quantity: str
    expected_verdict: str
    dx: float
    duration: float
    level: float = LEVEL
    width: float = 1.0
    gamma: float = GAMMA
    ratio: float = DAMPING_RATIO  # beta/dx
    peak: float = 1.0
    bumps: tuple[tuple[float, float, float], ...] = ()
    damping_sign: int = 1
    other: dict[str, Any] = field(default_factory=dict)  # more parameters of Scene

    def exact_time(self) -> float:
        """Return the exact transition time, or the time at which two fronts meet, or else 1."""
        symmetric = Prestress(self.level, self.level, self.width)
        if self.family == "two nucleations":
            fronts = fast_fronts(symmetric, self.ratio, "total", NUCLEATION_DISTANCE)
            return float(fronts.arrival(0.5 * NUCLEATION_DISTANCE))
        if self.quantity != "T_trans":
            return 1.0
        if self.gamma == 0.0:
            crack = ArrestingCrack(Prestress(self.level, 0.0), self.ratio)
            return crack.transition(COVERED_FRACTION).time
        return exact_transition_displacement(symmetric, self.gamma, self.ratio).time

    def expected(self) -> float:
        """Return the exact value of the quantity; NaN if the case is refused or stopped.

        Quantities that measure an error or a drift, and those that count an event which should not
        happen, have the exact value 0.
        """
        if self.expected_verdict in (REFUSED, STOPPED):
            return math.nan
        if self.quantity in ("T_trans", "meeting time"):
            return self.exact_time()
        if self.quantity == "slip":
            in_double_precision = replace(self, dx=float(self.dx), gamma=float(self.gamma))
            return float(solve_on_lattice(in_double_precision.scene()).slip.max())
        if self.quantity not in ("front speed", "final slip"):
            return 0.0
        if self.family == "gamma":
            return value_or_nan(lambda: lattice_front_speed(self.level, self.gamma, self.dx))
        release = self.other.get("release", "total")
        beta = self.ratio * self.dx
        pulse = steady_pulse(
            self.level, self.gamma, beta, damping_ratio=self.ratio, release=release
        )
        return pulse.speed if self.quantity == "front speed" else pulse.slip

    def scene(self) -> Scene:
        """Return the scene, with a stable step unless the case sets another one."""
        has_springs = self.gamma > 0.0
        right_level = self.level if has_springs else 0.0
        duration = self.duration * self.exact_time()
        if has_springs and self.quantity == "T_trans":
            # On a lattice the transition is a few blocks late.
            duration += 4.0 * self.dx
        stable_step = choose_step("localised", 4, self.ratio, self.gamma * self.dx**2)
        other = {"max_step": min(0.5, stable_step)} | self.other
        return Scene(
            boundary="displacement" if has_springs else "stress",
            prestress=Prestress(self.level, right_level, self.width, self.peak, bumps=self.bumps),
            duration=duration,
            dx=self.dx,
            gamma=self.gamma,
            beta=self.ratio * self.dx,
            **other,
        )


def levels_near_1() -> list[Case]:
    """Return cases of undamped fronts at 7 to 70 wave speeds, which are exact at any spacing."""
    return [
        Case(
            family="level near 1",
            label=f"tau_0 = {level:g}",
            quantity="front speed",
            expected_verdict=RIGHT,
            dx=0.1,
            duration=6.0,
            level=level,
            ratio=0.0,
        )
        for level in (0.99, 0.999, 0.9999)
    ]


def levels_near_0() -> list[Case]:
    """Return cases of pulses that are narrower than a block, have few blocks, or are resolved."""
    cases = []
    for level, dx, duration, width, verdict in (
        (0.05, 0.8, 60.0, 0.8, FLAGGED),
        (0.05, 0.005, 60.0, 0.02, RIGHT),
        (0.02, 0.4, 60.0, 0.4, FLAGGED),
        (0.02, 0.002, 100.0, 0.02, RIGHT),
        (0.01, 0.4, 60.0, 0.4, FLAGGED),
        (0.01, 0.01, 60.0, 0.02, FLAGGED),
    ):
        label = f"tau_0 = {level:g}, dx = {dx:g}"
        case = Case(
            family="level near 0",
            label=label,
            quantity="final slip",
            expected_verdict=verdict,
            dx=dx,
            duration=duration,
            level=level,
            width=width,
        )
        cases.append(case)
    return cases


def extreme_gammas() -> list[Case]:
    """Return cases of transitions at small gamma, and of front speeds up to large gamma dx^2."""
    # At the smallest gamma the slip is 1e8, and the length scale of the leaf springs is 500 blocks.
    cases = [
        Case(
            family="gamma",
            label=f"gamma = {gamma:g}",
            quantity="T_trans",
            expected_verdict=RIGHT,
            dx=dx,
            duration=JUST_LONG_ENOUGH,
            width=4.0 * dx,
            gamma=gamma,
        )
        for gamma, dx in ((1e-8, 20.0), (1e-4, 0.2))
    ]
    dx = 0.01
    # Beyond the last but one gamma no front on the lattice is faster than the waves.
    for gamma, verdict in (
        (1.0, RIGHT),
        (100.0, RIGHT),
        (1000.0, FLAGGED),
        (6000.0, FLAGGED),
        (1e4, FLAGGED),
        (1e5, FLAGGED),
    ):
        case = Case(
            family="gamma",
            label=f"gamma dx^2 = {gamma * dx**2:g}",
            quantity="front speed",
            expected_verdict=verdict,
            dx=dx,
            duration=40.0 / math.sqrt(gamma),
            width=0.1,
            gamma=gamma,
            ratio=0.0,
        )
        cases.append(case)
    return cases


def strong_damping() -> list[Case]:
    """Return cases of front speeds under both release rules, at damping ratios from 0 to 100.

    Strong damping makes fronts under the total rule fast, so they settle early. Under the elastic
    rule, the theory holds only if the damped layer at the front is thin compared with the pulse.
    """
    cases = []
    for release, ratio, duration, verdict in (
        ("total", 0.0, 40.0, RIGHT),
        ("total", 1.0, 40.0 / 1.05, RIGHT),
        ("total", 10.0, 40.0 / 1.5, RIGHT),
        ("total", 100.0, 40.0 / 6.0, RIGHT),
        ("elastic", 1.0, 40.0, RIGHT),
        ("elastic", 10.0, 40.0, FLAGGED),
        ("elastic", 100.0, 40.0, FLAGGED),
    ):
        case = Case(
            family="damping",
            label=f"beta/dx = {ratio:g}, {release}",
            quantity="front speed",
            expected_verdict=verdict,
            dx=0.05,
            duration=duration,
            level=0.3,
            ratio=ratio,
            other={"release": release},
        )
        cases.append(case)
    return cases


def extreme_spacings() -> list[Case]:
    """Return cases with spacings from one layer thickness to a thousandth."""
    cases = []
    for dx, quantity, duration, verdict in (
        (1.0, "front speed", 60.0, FLAGGED),
        (0.3, "front speed", 60.0, RIGHT),
        (0.1, "front speed", 60.0, RIGHT),
        (0.01, "front speed", 60.0, RIGHT),
        (0.1, "T_trans", JUST_LONG_ENOUGH, RIGHT),
        (0.01, "T_trans", JUST_LONG_ENOUGH, RIGHT),
        (0.001, "T_trans", JUST_LONG_ENOUGH, RIGHT),
    ):
        cases.append(Case("spacing", f"dx = {dx:g}", quantity, verdict, dx=dx, duration=duration))
    return cases


def extreme_nucleations() -> list[Case]:
    """Return cases with narrow Gaussians, and one with a width of 1000 layer thicknesses."""
    cases = []
    # A peak that is narrower than a block could lie unseen between two blocks.
    for width_in_blocks, verdict in ((0.5, REFUSED), (1.0, RIGHT), (2.0, RIGHT)):
        case = Case(
            family="nucleation",
            label=f"W = {width_in_blocks:g} dx",
            quantity="front speed",
            expected_verdict=verdict,
            dx=0.05,
            duration=20.0,
            width=width_in_blocks * 0.05,
        )
        cases.append(case)
    wide = Case(
        "nucleation", "W = 1000", "T_trans", RIGHT, dx=1.0, duration=JUST_LONG_ENOUGH, width=1000.0
    )
    return [*cases, wide]


def negative_levels() -> list[Case]:
    """Return cases of arrests of the left front in strongly negative pre-stress.

    Beyond a limit that is set by the friction ratio, blocks would slide back. Without damping the
    ringing of the lattice stalls such fronts, and on coarse lattices they are late.
    """
    cases = []
    for level, dx, friction_ratio, ratio, verdict in (
        (-1.0, 0.005, 5.0, 0.1, RIGHT),
        (-1.0, 0.01, 5.0, 0.0, FLAGGED),
        (-10.0, 0.02, 5.0, 0.1, FLAGGED),
        (-10.0, 0.004, 5.0, 0.1, RIGHT),
        (-30.0, 0.002, 5.0, 0.1, FLAGGED),
        (-30.0, 0.002, 60.0, 0.1, RIGHT),
        (-100.0, 0.05, 60.0, 0.1, FLAGGED),
        (-100.0, 0.001, 60.0, 0.1, RIGHT),
    ):
        case = Case(
            family="negative level",
            label=f"tau_l = {level:g}, dx {dx:g}, b {ratio:g}, r {friction_ratio:g}",
            quantity="T_trans",
            expected_verdict=verdict,
            dx=dx,
            duration=1.5,
            level=level,
            gamma=0.0,
            ratio=ratio,
            other={"friction_ratio": friction_ratio},
        )
        cases.append(case)
    return cases


def long_duration() -> list[Case]:
    """Return cases that measure what rounding changes in a steady pulse over a very long run."""
    return [
        Case(
            family="duration",
            label="t = 100000",
            quantity=quantity,
            expected_verdict=RIGHT,
            dx=1.0,
            duration=1e5,
            width=2.0,
            gamma=0.01,
        )
        for quantity in ("speed drift", "slip drift", "energy residual")
    ]


def single_precision() -> list[Case]:
    """Return cases with parameters or with a state in single precision.

    Such parameters are converted to double precision. The solver does not offer such a state.
    """
    parameters = Case(
        family="float32",
        label="parameters",
        quantity="slip",
        expected_verdict=RIGHT,
        dx=SINGLE_PRECISION(0.1),
        duration=5.0,
        gamma=SINGLE_PRECISION(GAMMA),
        ratio=0.0,
    )
    states = [
        Case(
            family="float32",
            label=f"state, gamma = {gamma:g}",
            quantity="velocity error",
            expected_verdict=NOT_OFFERED,
            dx=0.1,
            duration=0.9 * math.pi / math.sqrt(gamma),
            width=0.8,
            gamma=gamma,
            ratio=0.0,
        )
        for gamma in (0.01, 1e-3)
    ]
    return [parameters, *states]


def peaks_near_threshold() -> list[Case]:
    """Return cases with the peak of the pre-stress just below and just above the threshold.

    A peak below the threshold releases nothing. One just above it acts like one at it.
    """
    return [
        Case("peak", "1 - 1e-09", "releases", RIGHT, dx=0.05, duration=30.0, peak=1.0 - 1e-9),
        Case("peak", "1 - 0.001", "releases", RIGHT, dx=0.05, duration=30.0, peak=1.0 - 1e-3),
        Case("peak", "1 + 1e-09", "front speed", RIGHT, dx=0.05, duration=30.0, peak=1.0 + 1e-9),
        Case("peak", "1 + 0.001", "front speed", RIGHT, dx=0.05, duration=30.0, peak=1.0 + 1e-3),
    ]


def two_nucleations() -> list[Case]:
    """Return cases of fronts from two equal peaks.

    They meet halfway, at the time when a single front would arrive there.
    """
    # With this bump the pre-stress is 1 there too.
    twin = ((NUCLEATION_DISTANCE, 1.0 - LEVEL, 1.0),)
    return [
        Case(
            "two nucleations", "20 apart", "meeting time", RIGHT, dx=0.02, duration=1.5, bumps=twin
        ),
        Case("two nucleations", "20 apart", "asymmetry", RIGHT, dx=0.02, duration=3.0, bumps=twin),
    ]


def barriers() -> list[Case]:
    """Return cases of a deep barrier, which stops the pulse, and a shallow one, which does not."""
    deep, shallow = barrier(1.5), barrier(0.2)
    return [
        Case("barrier", "depth 1.5", "passes by", RIGHT, dx=0.05, duration=60.0, bumps=deep),
        Case("barrier", "depth 0.2", "front speed", RIGHT, dx=0.05, duration=60.0, bumps=shallow),
    ]


def barrier(depth: float) -> tuple[tuple[float, float, float], ...]:
    """Return bumps of negative pre-stress on both sides, which a steady pulse runs into."""
    return (BARRIER_CENTRE, -depth, BARRIER_WIDTH), (-BARRIER_CENTRE, -depth, BARRIER_WIDTH)


def unstable_runs() -> list[Case]:
    """Return cases that are unstable: damping with the printed sign, and too large steps.

    The printed sign makes grid modes grow. The steps exceed the stability bound of each scheme.
    """
    too_large = {"max_step": 3.0}
    textbook = {"scheme": "fixed_step"} | too_large
    return [
        Case(
            "damping sign", "as printed", "slip", STOPPED, dx=0.02, duration=10.0, damping_sign=-1
        ),
        Case(
            "step",
            "3 dx, localised",
            "front speed",
            REFUSED,
            dx=0.1,
            duration=10.0,
            other=too_large,
        ),
        Case(
            "step",
            "3 dx, fixed_step",
            "front speed",
            REFUSED,
            dx=0.1,
            duration=10.0,
            other=textbook,
        ),
    ]


CASES = [
    *levels_near_1(),
    *levels_near_0(),
    *extreme_gammas(),
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
