"""Edges of the solver's domain: one row an edge, with what should happen and what did."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from ..measurement.fronts import path
from ..measurement.table import measure_run
from ..model.prestress import Prestress
from ..model.scene import Scene
from ..model.stability import chosen_step
from ..predict.comparison import pulse_state
from ..simulation.sweep import simulate_on_lattice
from ..solver.lattice import UnstableRun
from ..solver.solution import solve_on_lattice
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import exact_transition_displacement
from ..theory.front_speeds import front_speed as exact_speed
from ..theory.front_speeds import lattice_front_speed
from ..theory.fronts import Fronts
from ..theory.pulse import steady_pulse

NEEDS = {"settings": ["measure.front_window"]}

# A common rupture, of which one number at a time is extreme.
LEVEL, GAMMA = 0.5, 0.65
RATIO = 0.1
# Relative errors, absolute where 0 is expected, by family or else by quantity: what the spacings
# below leave, and for drifts and symmetry what rounding does. Elsewhere equality is asked.
TOLERANCES = {
    "front speed": 0.01, "T_trans": 0.01, "meeting time": 0.01, "velocity error": 0.01, "step": 0.0,
    "final slip": 0.05, "negative level": 0.05, "speed drift": 1e-6, "slip drift": 1e-6,
    "energy residual": 1e-5, "asymmetry": 1e-9,
}  # fmt: skip
# The left front never covers all of its way: the time at which it has covered this is compared.
FRACTION = 0.95
# Two fronts are steady when they meet if their nucleations are this far apart.
APART = 20.0
# A pulse is steady when it meets a barrier with this centre and width.
CENTRE, WIDTH = 25.0, 2.0
# The steady pulse is expected where these are measured, so its state belongs to the flags.
OF_PULSES = ("front speed", "final slip", "speed drift", "slip drift", "energy residual")
# These states say that all is well.
FINE = ("", "steady", "none", "resolved")
# Columns of the measured table; the other quantities are measured here.
MEASURED = {
    "front speed": "front_speed_right",
    "final slip": "pulse_slip",
    "T_trans": "transition_time",
    "energy residual": "energy_residual",
}
NOT_OFFERED = "not offered"


@dataclass(frozen=True)
class Setup:
    """The common rupture with some of its numbers changed; a Scene may refuse it."""

    dx: float
    duration: float
    level: float = LEVEL
    right: float | None = None  # None: the level, on both sides
    width: float = 1.0
    peak: float = 1.0
    bumps: tuple[tuple[float, float, float], ...] = ()
    gamma: float = GAMMA  # 0: the stress boundary
    ratio: float = RATIO
    damping_sign: int = 1
    other: dict[str, Any] = field(default_factory=dict)  # parameters of Scene

    def scene(self) -> Scene:
        """The scene, with a stable step unless another is given."""
        right = self.level if self.right is None else self.right
        profile = Prestress(self.level, right, self.width, self.peak, bumps=self.bumps)
        boundary = "displacement" if self.gamma > 0.0 else "stress"
        step = chosen_step("localised", 4, self.ratio, self.gamma * self.dx**2, enough=0.5)
        other = {"max_step": step} | self.other
        beta = self.ratio * self.dx
        return Scene(boundary, profile, self.duration, self.dx, self.gamma, beta, **other)


@dataclass(frozen=True)
class Edge:
    """One edge: where it is, the quantity compared, the verdict it should have, the exact value."""

    value: str
    quantity: str
    should: str
    expected: float
    setup: Setup


class Outcome(NamedTuple):
    """The value measured at an edge, flags or a refusal, and block updates."""

    value: float = math.nan
    message: str = ""
    block_updates: int = 0


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """One row an edge: family, value, quantity, should, tolerance, expected, measured, error,
    verdict, message (flags or the refusal), block_updates.
    """
    window = settings["measure"]["front_window"]
    rows = []
    for family, edges in FAMILIES.items():
        rows += [row(family, edge, window) for edge in edges()]
    return pd.DataFrame(rows)


def speed(level: float = LEVEL, ratio: float = RATIO, release: str = "total") -> float:
    """Exact front speed into a level."""
    return float(exact_speed(level, ratio, release))


def first_stick(value: str, dx: float, width: float = 1.0, gamma: float = GAMMA) -> Edge:
    """Edge of a rupture that just reaches its T_trans, which is that of the continuum."""
    exact = exact_transition_displacement(Prestress(LEVEL, LEVEL, width), gamma, RATIO).time
    setup = Setup(dx, 1.02 * exact + 4.0 * dx, width=width, gamma=gamma)
    return Edge(value, "T_trans", "right", exact, setup)


def level_near_one() -> Iterator[Edge]:
    """Undamped fronts at 7 to 70 wave speeds, which are exact at any spacing."""
    for level in (0.99, 0.999, 0.9999):
        setup = Setup(0.1, 6.0, level, ratio=0.0)
        yield Edge(f"tau_0 = {level:g}", "front speed", "right", speed(level, 0.0), setup)


def level_near_zero() -> Iterator[Edge]:
    """Pulses narrower than a block, or of fewer blocks than a Scene asks for; others resolved."""
    for level, dx, duration, should in (
        (0.05, 0.8, 60.0, "flagged"),
        (0.05, 0.005, 60.0, "right"),
        (0.02, 0.4, 60.0, "flagged"),
        (0.02, 0.002, 100.0, "right"),
        (0.01, 0.4, 60.0, "flagged"),
        (0.01, 0.01, 60.0, "flagged"),
    ):
        slip = steady_pulse(level, GAMMA, RATIO * dx, speed(level)).slip
        setup = Setup(dx, duration, level, width=max(0.02, dx))
        yield Edge(f"tau_0 = {level:g}, dx = {dx:g}", "final slip", should, slip, setup)


def elasticity_ratio() -> Iterator[Edge]:
    """Slip of 1e8, and a gamma beyond which no front on the lattice is faster than the waves."""
    for gamma in (1e-8, 1e-4):
        # 500 blocks to the scale of the leaf springs.
        dx = 1.0 / (500.0 * math.sqrt(gamma))
        yield first_stick(f"gamma = {gamma:g}", dx, 4.0 * dx, gamma)
    for gamma in (1.0, 100.0, 1000.0, 6000.0, 1e4, 1e5):
        expected = lattice_front_speed(LEVEL, gamma, 0.01) if gamma < 1e4 else math.nan
        should = "right" if gamma <= 100.0 else "flagged"
        setup = Setup(0.01, 40.0 / math.sqrt(gamma), width=0.1, gamma=gamma, ratio=0.0)
        yield Edge(f"gamma dx^2 = {gamma * 0.01**2:g}", "front speed", should, expected, setup)


def damping() -> Iterator[Edge]:
    """Strong damping; under the elastic rule the damped layer must be thin against the pulse."""
    for release, ratios in (("total", (0.0, 1.0, 10.0, 100.0)), ("elastic", (1.0, 10.0, 100.0))):
        for ratio in ratios:
            should = "right" if release == "total" or ratio == 1.0 else "flagged"
            # Strong damping makes fronts under the total rule fast, so that they settle early.
            duration = 40.0 / (1.0 + 0.05 * ratio) if release == "total" else 40.0
            setup = Setup(0.05, duration, 0.3, ratio=ratio, other={"release": release})
            expected = speed(0.3, ratio, release)
            yield Edge(f"beta/dx = {ratio:g}, {release}", "front speed", should, expected, setup)


def spacing() -> Iterator[Edge]:
    """Spacings from one layer thickness to a thousandth."""
    for dx, should in ((1.0, "flagged"), (0.3, "right"), (0.1, "right"), (0.01, "right")):
        yield Edge(f"dx = {dx:g}", "front speed", should, speed(), Setup(dx, 60.0))
    for dx in (0.1, 0.01, 1e-3):
        yield first_stick(f"dx = {dx:g}", dx)


def nucleation() -> Iterator[Edge]:
    """A peak between two blocks, which cannot be seen; one of a block; one of 1000 thicknesses."""
    narrow, one, two = (Setup(0.05, 20.0, width=factor * 0.05) for factor in (0.5, 1.0, 2.0))
    yield Edge("W = 0.5 dx", "front speed", "refused", math.nan, narrow)
    yield Edge("W = 1 dx", "front speed", "right", speed(), one)
    yield Edge("W = 2 dx", "front speed", "right", speed(), two)
    yield first_stick("W = 1000", 1.0, 1000.0)


def negative_level() -> Iterator[Edge]:
    """Fronts into negative pre-stress, which may slide in reverse from the friction ratio on.

    The lattice stalls them where nothing damps its ringing, and late where it is coarse.
    """
    for level, dx, friction, ratio, should in (
        (-1.0, 0.005, 5.0, 0.1, "right"),
        (-1.0, 0.01, 5.0, 0.0, "flagged"),
        (-10.0, 0.02, 5.0, 0.1, "flagged"),
        (-10.0, 0.004, 5.0, 0.1, "right"),
        (-30.0, 0.002, 5.0, 0.1, "flagged"),
        (-30.0, 0.002, 60.0, 0.1, "right"),
        (-100.0, 0.05, 60.0, 0.1, "flagged"),
        (-100.0, 0.001, 60.0, 0.1, "right"),
    ):
        time = ArrestingCrack(Prestress(level, 0.0), ratio).time_at_fraction(FRACTION)
        other = {"friction_ratio": friction}
        setup = Setup(dx, 1.5 * time, level, 0.0, gamma=0.0, ratio=ratio, other=other)
        value = f"tau_l = {level:g}, dx {dx:g}, b {ratio:g}, r {friction:g}"
        yield Edge(value, "T_trans", should, time, setup)


def duration() -> Iterator[Edge]:
    """The drift of a steady pulse over a very long run, by rounding."""
    setup = Setup(1.0, 1e5, width=2.0, gamma=0.01)
    for quantity in ("speed drift", "slip drift", "energy residual"):
        yield Edge("t = 100000", quantity, "right", 0.0, setup)


def single_precision() -> Iterator[Edge]:
    """Parameters in float32 are computed with in double; a state in float32 is not offered."""
    dx: Any = np.float32(0.1)
    gamma: Any = np.float32(GAMMA)
    double = Setup(float(dx), 5.0, gamma=float(gamma), ratio=0.0)
    slip = float(solve_on_lattice(double.scene()).slip.max())
    yield Edge("parameters", "slip", "right", slip, Setup(dx, 5.0, gamma=gamma, ratio=0.0))
    for soft in (0.01, 1e-3):
        crack = Setup(0.1, 0.9 * math.pi / math.sqrt(soft), width=0.8, gamma=soft, ratio=0.0)
        yield Edge(f"state, gamma = {soft:g}", "velocity error", NOT_OFFERED, 0.0, crack)


def peak() -> Iterator[Edge]:
    """A peak just below the threshold moves nothing; one just above it is as one at it."""
    for value, offset in (("1 - 1e-09", -1e-9), ("1 - 0.001", -1e-3)):
        yield Edge(value, "releases", "right", 0.0, Setup(0.05, 30.0, peak=1.0 + offset))
    for value, offset in (("1 + 1e-09", 1e-9), ("1 + 0.001", 1e-3)):
        yield Edge(value, "front speed", "right", speed(), Setup(0.05, 30.0, peak=1.0 + offset))


def two_nucleations() -> Iterator[Edge]:
    """Fronts of two equal peaks, which meet halfway when one of them takes to get there."""
    exact = float(Fronts(Prestress(LEVEL, LEVEL), RATIO, "total", APART).arrival(0.5 * APART))
    bumps = ((APART, 1.0 - LEVEL, 1.0),)
    value, meeting = f"{APART:g} apart", Setup(0.02, 1.5 * exact, bumps=bumps)
    yield Edge(value, "meeting time", "right", exact, meeting)
    yield Edge(value, "asymmetry", "right", 0.0, Setup(0.02, 3.0 * exact, bumps=bumps))


def barrier() -> Iterator[Edge]:
    """A deep barrier of negative pre-stress, which stops the pulse, and a shallow one."""
    for depth, quantity, expected in ((1.5, "passes by", 0.0), (0.2, "front speed", speed())):
        bumps = ((CENTRE, -depth, WIDTH), (-CENTRE, -depth, WIDTH))
        yield Edge(f"depth {depth:g}", quantity, "right", expected, Setup(0.05, 60.0, bumps=bumps))


def damping_sign() -> Iterator[Edge]:
    """The damping term as the paper prints it, which feeds the grid modes."""
    yield Edge("as printed", "slip", "stopped", math.nan, Setup(0.02, 10.0, damping_sign=-1))


def step() -> Iterator[Edge]:
    """A step beyond the stability bound of each scheme."""
    for scheme in ("localised", "fixed_step"):
        setup = Setup(0.1, 10.0, other={"scheme": scheme, "max_step": 3.0})
        yield Edge(f"3 dx, {scheme}", "front speed", "refused", math.nan, setup)


FAMILIES: dict[str, Callable[[], Iterator[Edge]]] = {
    "level near 1": level_near_one,
    "level near 0": level_near_zero,
    "gamma": elasticity_ratio,
    "damping": damping,
    "spacing": spacing,
    "nucleation": nucleation,
    "negative level": negative_level,
    "duration": duration,
    "float32": single_precision,
    "peak": peak,
    "two nucleations": two_nucleations,
    "barrier": barrier,
    "damping sign": damping_sign,
    "step": step,
}


def row(family: str, edge: Edge, window: float) -> dict[str, Any]:
    """Run an edge and judge it."""
    tolerance = TOLERANCES.get(family, TOLERANCES.get(edge.quantity, 0.0))
    error = math.nan
    try:
        outcome = measured(edge, window)
        error = abs(outcome.value - edge.expected) / (abs(edge.expected) or 1.0)
        verdict = judge(outcome, error <= tolerance)
    except UnstableRun as stopped:
        verdict, outcome = "stopped", Outcome(message=str(stopped))
    except ValueError as refusal:
        verdict, outcome = "refused", Outcome(message=str(refusal))
    return {
        "family": family,
        "value": edge.value,
        "quantity": edge.quantity,
        "should": edge.should,
        "tolerance": tolerance,
        "expected": edge.expected,
        "measured": outcome.value,
        "error": error,
        "verdict": verdict,
        "message": outcome.message,
        "block_updates": outcome.block_updates,
    }


def judge(outcome: Outcome, within: bool) -> str:
    """The verdict: a flag wins; then a number that is missing; then the number itself.

    A number where theory has none is not within its tolerance.
    """
    if outcome.message:
        return NOT_OFFERED if outcome.message == NOT_OFFERED else "flagged"
    if math.isnan(outcome.value):
        return "no number"
    return "right" if within else "WRONG WITHOUT A FLAG"


# The three edges of the longest run share it.
simulated = lru_cache(maxsize=1)(simulate_on_lattice)


def measured(edge: Edge, window: float) -> Outcome:
    """Run an edge and measure it; raises what a refused scene or a stopped run raises."""
    if edge.quantity == "velocity error":
        return Outcome(single_precision_error(edge.setup), NOT_OFFERED)
    scene = edge.setup.scene()
    if edge.quantity == "slip":
        return Outcome(
            float(solve_on_lattice(scene, damping_sign=edge.setup.damping_sign).slip.max())
        )
    run = simulated(scene)
    if edge.quantity == "releases":
        # A run without a release is flagged, and right here.
        return Outcome(float(run.attrs["releases"]), block_updates=run.attrs["block_updates"])
    settings = {"front_window": window, "share": FRACTION, "trailing_times": ()}
    numbers, pulse = measure_run(run, settings)
    flags = [numbers["run_flags"], numbers.get("transition_state", "")]
    if pulse is not None and edge.quantity in OF_PULSES:
        flags.append(pulse_state(run, pulse))
    known = MEASURED.get(edge.quantity)
    value = numbers[known] if known else measured_here(run, edge.quantity)
    message = ",".join(flag for flag in flags if flag not in FINE)
    return Outcome(value, message, run.attrs["block_updates"])


def measured_here(run: xr.Dataset, quantity: str) -> float:
    """A quantity of a run that the measured table does not have."""
    x, slip = run["x"].values, run["slip"].values
    if quantity == "meeting time":
        middle = np.abs(x - 0.5 * APART) < 1.5 * run.attrs["dx"]
        return float(np.nanmax(run["release_time"].values[middle]))
    if quantity == "asymmetry":
        mirrored = np.interp(APART - x, x, slip, left=0.0, right=0.0)
        return float(np.max(np.abs(slip - mirrored)) / slip.max())
    if quantity == "passes by":
        return max(0.0, float(path(run)[1][-1]) - CENTRE)
    return drift(run, quantity)


def drift(run: xr.Dataset, quantity: str) -> float:
    """Relative change of the front speed or of the slip behind it, over most of a path."""
    times, distances = path(run)
    x, last = run["x"].values, distances[-1]

    def number(start: float, end: float) -> float:
        if quantity == "slip drift":
            left_behind = (x > start * last) & (x < (end - 0.01) * last)
            return float(np.mean(run["slip"].values[left_behind]))
        part = (distances > start * last) & (distances < end * last)
        return float(np.polyfit(times[part], distances[part], 1)[0])

    return number(0.9, 1.0) / number(0.2, 0.3) - 1.0


def single_precision_error(setup: Setup) -> float:
    """Relative error of a crack's slip velocity whose state is in float32, against float64.

    Symplectic Euler on slip, with the force from second differences of slip; no damping.
    """
    dx, step = setup.dx, 0.4 * setup.dx
    x = dx * np.arange(int(1.5 * setup.duration / dx) + 32)
    tau = setup.level + (1.0 - setup.level) * np.exp(-0.5 * (x / setup.width) ** 2)
    velocities = []
    for dtype in (np.float64, np.float32):
        # A plain number takes the type of the array that it meets.
        stress: np.ndarray = tau.astype(dtype)
        slip, velocity, force = np.zeros((3, x.size), dtype)
        sliding = stress >= 1.0
        for _ in range(round(setup.duration / step)):
            force[1:-1] = 1.0 / dx**2 * (slip[2:] - 2.0 * slip[1:-1] + slip[:-2])
            force[0] = 2.0 / dx**2 * (slip[1] - slip[0])
            force[:-1] += stress[:-1] - setup.gamma * slip[:-1]
            sliding |= force >= 1.0
            velocity = np.where(sliding, np.maximum(velocity + step * force, 0.0), 0.0)
            slip += step * velocity
        velocities.append(velocity)
    double, single = velocities
    return float(np.max(np.abs(double - single)) / np.max(double))
