"""The edges of the solver's domain: one row an edge, with what should happen and what did."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from ..comparison.steadiness import pulse_state
from ..measure.fronts import front_speed, path
from ..measure.pulses import leading_pulse
from ..measure.transition import transition_stress
from ..model.prestress import Prestress
from ..model.scene import Scene
from ..model.stability import MARGIN, largest_step
from ..simulation.simulate import UnstableRun, simulate
from ..solver.run import run_scene
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import Fronts, exact_transition_displacement
from ..theory.front_law import front_speed as exact_speed
from ..theory.front_law import lattice_front_speed
from ..theory.pulse import steady_pulse

NEEDS = {"settings": ["measure.front_window"]}

# Of every scene that does not say otherwise: a common rupture, so that one number of it at a time is extreme.
GAMMA, LEVEL, RATIO = 0.65, 0.5, 0.1
# Relative errors, absolute where 0 is expected: what a spacing of the scene below leaves, and of the last four what
# rounding leaves.
TOLERANCES = {
    "front speed": 0.01, "final slip": 0.05, "T_trans": 0.01, "velocity error": 0.01, "speed drift": 1e-6,
    "slip drift": 1e-6, "energy residual": 1e-5, "asymmetry": 1e-9,
}  # fmt: skip
# The fraction of a way that never ends, and how exactly its time is met.
FRACTION, FRACTION_TOLERANCE = 0.95, 0.05
# Long enough for a drift of rounding to show.
LONG = 1e5
# Two nucleations this far apart: each front is steady when they meet.
APART = 20.0
# Centre and width of a barrier, which the pulse meets when it is steady.
BARRIER = 25.0, 2.0


class Found(NamedTuple):
    """What one run gave; ``expected`` is NaN where no theory has a value."""

    expected: float
    measured: float
    flags: str = ""
    block_updates: int = 0


class Edge(NamedTuple):
    """One row: a family, the value at its edge, what is compared, what should happen, and how to find out.

    ``run`` returns what was found, raises ValueError when the scene is refused and UnstableRun when it is stopped.
    """

    family: str
    value: str
    quantity: str
    should: str
    run: Callable[[], Found]
    tolerance: float | None = None


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Run every edge.

    Parameters
    ----------
    settings : measure (front_window)

    Returns
    -------
    one row an edge: family, value, quantity, should, tolerance, expected, measured, error, verdict, message (flags or
    the refusal), block_updates
    """
    return pd.DataFrame([row(edge) for edge in edges(settings["measure"]["front_window"])])


def row(edge: Edge) -> dict[str, Any]:
    """Run an edge and judge it: a flag wins; then a number that is missing; then the number itself."""
    tolerance = TOLERANCES.get(edge.quantity, 0.0) if edge.tolerance is None else edge.tolerance
    found, verdict = Found(math.nan, math.nan), ""
    try:
        found = edge.run()
    except UnstableRun as error:
        found, verdict = found._replace(flags=str(error)), "stopped"
    except ValueError as error:
        found, verdict = found._replace(flags=str(error)), "refused"
    off = abs(found.measured - found.expected) / (abs(found.expected) or 1.0)
    if not verdict:
        if found.flags:
            verdict = "not offered" if found.flags == "not offered" else "flagged"
        elif not math.isfinite(found.measured):
            verdict = "no number"
        else:
            # Comparisons with NaN are False: a number where theory has none is wrong unless it was flagged.
            verdict = "right" if off <= tolerance else "WRONG WITHOUT A FLAG"
    return {
        "family": edge.family, "value": edge.value, "quantity": edge.quantity, "should": edge.should,
        "tolerance": tolerance, "expected": found.expected, "measured": found.measured, "error": off,
        "verdict": verdict, "message": found.flags, "block_updates": found.block_updates,
    }  # fmt: skip


def edges(window: float) -> Iterator[Edge]:
    """Every edge, and what should happen there.

    Flagged are pulses of fewer blocks than a Scene asks for, fronts with a damped layer that is not thin against the
    pulse, and fronts into negative pre-stress that the lattice stalls or that slide in reverse.
    """
    speed, even_speed = partial(front, window), partial(even_front, window)
    # Undamped fronts at 7 to 70 wave speeds are exact at any spacing.
    for level in (0.99, 0.999, 0.9999):
        run = partial(even_speed, 0.1, 6.0, level, ratio=0.0)
        yield Edge("level near 1", f"tau_0 = {level:g}", "front speed", "right", run)
    # Pulses narrower than a block, and the same resolved.
    for level, dx, duration, should in (
        (0.05, 0.8, 60.0, "flagged"), (0.05, 0.005, 60.0, "right"), (0.02, 0.4, 60.0, "flagged"),
        (0.02, 0.002, 100.0, "right"), (0.01, 0.4, 60.0, "flagged"), (0.01, 0.01, 60.0, "flagged"),
    ):  # fmt: skip
        run = partial(final_slip, window, level, dx, duration)
        yield Edge("level near 0", f"tau_0 = {level:g}, dx = {dx:g}", "final slip", should, run)
    # Slip of 1e8, on the scale of the leaf springs: 500 blocks to 1/sqrt(gamma).
    for gamma in (1e-8, 1e-4):
        dx = 1.0 / (500.0 * math.sqrt(gamma))
        yield Edge(
            "gamma", f"gamma = {gamma:g}", "T_trans", "right", partial(first_stick, dx, 4.0 * dx, gamma)
        )
    # To beyond the largest gamma for which the lattice has a front faster than the waves.
    for gamma in (1.0, 100.0, 1000.0, 6000.0, 1e4, 1e5):
        of = scene(even(LEVEL, 0.1), 0.01, 40.0 / math.sqrt(gamma), 0.0, gamma)
        run = partial(speed, of, lattice_speed(gamma, of.dx))
        should = "right" if gamma <= 100.0 else "flagged"
        yield Edge("gamma", f"gamma dx^2 = {gamma * of.dx**2:g}", "front speed", should, run)
    # The elastic rule meets leaf springs within its damped layer, which must be told.
    for release, ratio in (
        *(("total", ratio) for ratio in (0.0, 1.0, 10.0, 100.0)),
        *(("elastic", ratio) for ratio in (1.0, 10.0, 100.0)),
    ):
        # Strong damping under the total rule: a fast front, settled early.
        duration = 40.0 / (1.0 + 0.05 * ratio) if release == "total" else 40.0
        run = partial(even_speed, 0.05, duration, 0.3, ratio=ratio, release=release)
        should = "flagged" if release == "elastic" and ratio > 1.0 else "right"
        yield Edge("damping", f"beta/dx = {ratio:g}, {release}", "front speed", should, run)
    # One layer thickness to a thousandth.
    for dx, should in ((1.0, "flagged"), (0.3, "right"), (0.1, "right"), (0.01, "right")):
        yield Edge("spacing", f"dx = {dx:g}", "front speed", should, partial(even_speed, dx, 60.0))
    for dx in (0.1, 0.01, 1e-3):
        yield Edge("spacing", f"dx = {dx:g}", "T_trans", "right", partial(first_stick, dx))
    # A peak between two blocks cannot be seen; one block is enough for the front; 1000 layer thicknesses.
    for factor, should in ((0.5, "refused"), (1.0, "right"), (2.0, "right")):
        run = partial(even_speed, 0.05, 20.0, width=factor * 0.05)
        yield Edge("nucleation", f"W = {factor:g} dx", "front speed", should, run)
    yield Edge("nucleation", "W = 1000", "T_trans", "right", partial(first_stick, 1.0, 1000.0))
    # Reverse sliding from the friction ratio on. Without damping the ringing of the lattice stalls the left front; with
    # it only a coarse lattice does.
    for level, dx, friction, ratio, should in (
        (-1.0, 0.005, 5.0, 0.1, "right"), (-1.0, 0.01, 5.0, 0.0, "flagged"), (-10.0, 0.02, 5.0, 0.1, "flagged"),
        (-10.0, 0.004, 5.0, 0.1, "right"), (-30.0, 0.002, 5.0, 0.1, "flagged"), (-30.0, 0.002, 60.0, 0.1, "right"),
        (-100.0, 0.05, 60.0, 0.1, "flagged"), (-100.0, 0.001, 60.0, 0.1, "right"),
    ):  # fmt: skip
        value = f"tau_l = {level:g}, dx {dx:g}, b {ratio:g}, r {friction:g}"
        run = partial(time_of_fraction, level, dx, ratio, friction)
        yield Edge("negative level", value, "T_trans", should, run, FRACTION_TOLERANCE)
    # Speed, slip and energy of a pulse over a long time must not drift.
    for quantity in ("speed drift", "slip drift", "energy residual"):
        yield Edge("duration", f"t = {LONG:g}", quantity, "right", partial(drift, window, quantity))
    # Parameters in single precision are computed with in double; a state in single precision is not offered.
    yield Edge("float32", "parameters", "slip", "right", single_parameters)
    for gamma in (0.01, 1e-3):
        yield Edge(
            "float32",
            f"state, gamma = {gamma:g}",
            "velocity error",
            "not offered",
            partial(single_state, gamma),
        )
    # A hair below the threshold nothing moves; a hair above it all goes as at the threshold.
    for apart in (1e-9, 1e-3):
        yield Edge("peak", f"1 - {apart:g}", "releases", "right", partial(releases, 1.0 - apart))
    for apart in (1e-9, 1e-3):
        run = partial(
            speed, scene(even(LEVEL, peak=1.0 + apart), 0.05, 30.0), float(exact_speed(LEVEL, RATIO))
        )
        yield Edge("peak", f"1 + {apart:g}", "front speed", "right", run)
    # Two equal peaks: their fronts meet halfway, at the time that one of them takes to get there.
    for quantity, tolerance in (("meeting time", TOLERANCES["T_trans"]), ("asymmetry", None)):
        run = partial(two_nucleations, quantity)
        yield Edge("two nucleations", f"{APART:g} apart", quantity, "right", run, tolerance)
    # A deep barrier of negative pre-stress stops the pulse, a shallow one only slows it.
    for depth, quantity in ((1.5, "passes by"), (0.2, "front speed")):
        yield Edge(
            "barrier", f"depth {depth:g}", quantity, "right", partial(barrier, window, quantity, depth)
        )
    # The damping term as the paper prints it feeds the grid modes.
    yield Edge("damping sign", "as printed", "slip", "stopped", printed_sign)
    for scheme in ("localised", "fixed_step"):
        run = partial(even_speed, 0.1, 10.0, scheme=scheme, max_step=3.0)
        yield Edge("step", f"3 dx, {scheme}", "front speed", "refused", run, 0.0)


def even(level: float, width: float = 1.0, **more) -> Prestress:
    """The same level on both sides."""
    return Prestress(level, level, width, **more)


def scene(
    prestress: Prestress, dx: float, duration: float, ratio: float = RATIO, gamma: float = GAMMA, **more: Any
) -> Scene:
    """A scene under the displacement boundary, or under the stress boundary when gamma is 0."""
    boundary = "displacement" if gamma > 0.0 else "stress"
    step = min(0.5, MARGIN * largest_step("localised", 4, ratio, gamma * dx**2))
    return Scene(boundary, prestress, duration, dx, gamma=gamma, beta=ratio * dx, **{"max_step": step} | more)


def flags_of(run: xr.Dataset, window: float) -> str:
    """Flags of the run, and the state of its pulse where that says that steady theory does not apply."""
    state = pulse_state(run, leading_pulse(run, window))
    return ",".join(filter(None, (run.attrs["run_flags"], "" if state in ("steady", "none") else state)))


def front(window: float, of: Scene, expected: float, beyond: float = 0.0) -> Found:
    """Front speed over the last part of the path, or beyond a distance."""
    run = simulate(of)
    measured = front_speed(run, window)[0]
    if beyond:
        times, distances = path(run)
        chosen = distances > beyond
        measured = float(np.polyfit(times[chosen], distances[chosen], 1)[0]) if chosen.sum() > 3 else math.nan
    return Found(expected, measured, flags_of(run, window), run.attrs["block_updates"])


def even_front(
    window: float,
    dx: float,
    duration: float,
    level: float = LEVEL,
    width: float = 1.0,
    ratio: float = RATIO,
    **more,
) -> Found:
    """Front speed in even pre-stress against the continuum's."""
    expected = float(exact_speed(level, ratio, more.get("release", "total")))
    return front(window, scene(even(level, width), dx, duration, ratio, **more), expected)


def lattice_speed(gamma: float, dx: float) -> float:
    """Undamped front speed of the lattice itself; NaN where it has none faster than the waves."""
    try:
        return lattice_front_speed(LEVEL, gamma, dx)
    except ValueError:
        return math.nan


def final_slip(window: float, level: float, dx: float, duration: float) -> Found:
    """Slip behind a pulse of little pre-stress."""
    of = scene(even(level, max(0.02, dx)), dx, duration)
    run = simulate(of)
    expected = steady_pulse(level, GAMMA, of.beta, float(exact_speed(level, RATIO))).slip
    return Found(expected, leading_pulse(run, window).slip, flags_of(run, window), run.attrs["block_updates"])


def first_stick(dx: float, width: float = 1.0, gamma: float = GAMMA) -> Found:
    """T_trans against the continuum's."""
    exact = exact_transition_displacement(even(LEVEL, width), gamma, RATIO).time
    numbers = simulate(scene(even(LEVEL, width), dx, 1.02 * exact + 4.0 * dx, gamma=gamma)).attrs
    return Found(exact, numbers["first_stick_time"], numbers["run_flags"], numbers["block_updates"])


def time_of_fraction(level: float, dx: float, ratio: float, friction_ratio: float) -> Found:
    """When the left front has covered a fraction of its way into negative pre-stress; a coarse lattice comes late."""
    profile = Prestress(level, 0.0)
    time = ArrestingCrack(profile, ratio).share_time(FRACTION)
    run = simulate(scene(profile, dx, 1.5 * time, ratio, 0.0, friction_ratio=friction_ratio))
    found = transition_stress(run, FRACTION)
    state = str(found["transition_state"])
    flags = ",".join(filter(None, (run.attrs["run_flags"], "" if state == "resolved" else state)))
    return Found(time, float(found["transition_time"]), flags, run.attrs["block_updates"])


@lru_cache(maxsize=1)
def long_run(window: float) -> tuple[dict[str, float], str, int]:
    """Relative changes between a fifth and nine tenths of a long path, and the residual of the energy."""
    run = simulate(scene(even(LEVEL, 2.0), 1.0, LONG, gamma=0.01))
    times, distances = path(run)
    x, far = run["x"].values, distances[-1]
    speeds, slips = [], []
    for start, end in ((0.2, 0.3), (0.9, 1.0)):
        part = (distances > start * far) & (distances < end * far)
        speeds.append(np.polyfit(times[part], distances[part], 1)[0])
        slips.append(float(np.mean(run["slip"].values[(x > start * far) & (x < (end - 0.01) * far)])))
    found = {
        "speed drift": float(speeds[1] / speeds[0] - 1.0),
        "slip drift": slips[1] / slips[0] - 1.0,
        "energy residual": run.attrs["energy_residual"],
    }
    return found, flags_of(run, window), run.attrs["block_updates"]


def drift(window: float, quantity: str) -> Found:
    found, flags, updates = long_run(window)
    return Found(0.0, found[quantity], flags, updates)


def single_parameters() -> Found:
    """Slip of a scene given in single precision against the same numbers in double."""
    gamma: Any = np.float32(GAMMA)
    dx: Any = np.float32(0.1)
    pairs = (float(gamma), float(dx)), (gamma, dx)
    double, single = (float(run_scene(scene(even(LEVEL), b, 5.0, 0.0, a)).slip.max()) for a, b in pairs)
    return Found(double, single)


def single_state(gamma: float) -> Found:
    """What single precision would cost: the textbook scheme in plain numpy, not part of the solver."""
    values = (gamma, LEVEL, 0.1, 0.9 * math.pi / math.sqrt(gamma), 0.4)
    double, single = (crack_velocity(*values, kind) for kind in (np.float64, np.float32))
    return Found(0.0, float(np.max(np.abs(double - single)) / np.max(double)), "not offered")


def crack_velocity(
    gamma: float, level: float, dx: float, duration: float, step: float, dtype: type
) -> np.ndarray:
    """Slip velocity of a crack from a Gaussian of width 8 dx at the end, right half, without damping.

    Parameters
    ----------
    step : in units of dx
    dtype : np.float32 or np.float64, of every array and constant

    Source: symplectic Euler on slip, the force from second differences of slip.
    """
    count = int(1.5 * duration / dx) + 32
    x = dx * np.arange(count)
    tau = (level + (1.0 - level) * np.exp(-0.5 * (x / (8.0 * dx)) ** 2)).astype(dtype)
    slip: np.ndarray = np.zeros(count, dtype)
    velocity, force, sliding = slip.copy(), slip.copy(), tau >= 1.0
    per_dx2, leaf, h = dtype(1.0 / dx**2), dtype(gamma), dtype(step * dx)
    for _ in range(round(duration / (step * dx))):
        force[1:-1] = per_dx2 * (slip[2:] - dtype(2.0) * slip[1:-1] + slip[:-2])
        force[0] = dtype(2.0) * per_dx2 * (slip[1] - slip[0])
        force[:-1] += tau[:-1] - leaf * slip[:-1]
        sliding |= force >= dtype(1.0)
        velocity = np.where(sliding, np.maximum(velocity + h * force, dtype(0.0)), dtype(0.0))
        slip += h * velocity
    return velocity


def releases(peak: float) -> Found:
    """How many blocks a peak below the threshold releases; that it is none is flagged, and right here."""
    numbers = simulate(scene(even(LEVEL, peak=peak), 0.05, 30.0)).attrs
    flags = numbers["run_flags"].replace("nothing_released", "")
    return Found(0.0, float(numbers["releases"]), flags, numbers["block_updates"])


def two_nucleations(quantity: str) -> Found:
    """When the fronts of two equal peaks meet, or by how much slip differs from its mirror image later."""
    dx = 0.02
    profile = even(LEVEL, bumps=((APART, 1.0 - LEVEL, 1.0),))
    exact = float(Fronts(even(LEVEL), RATIO, "total", APART).arrival(np.array([0.5 * APART]))[0])
    run = simulate(scene(profile, dx, (1.5 if quantity == "meeting time" else 3.0) * exact))
    x, slip = run["x"].values, run["slip"].values
    numbers = run.attrs["run_flags"], run.attrs["block_updates"]
    if quantity == "meeting time":
        between = np.abs(x - 0.5 * APART) < 1.5 * dx
        return Found(exact, float(np.nanmax(run["release_time"].values[between])), *numbers)
    mirrored = np.interp(APART - x, x, slip, left=0.0, right=0.0)
    return Found(0.0, float(np.max(np.abs(slip - mirrored)) / slip.max()), *numbers)


def barrier(window: float, quantity: str, depth: float) -> Found:
    """How far a front comes beyond the centre of a barrier, or its speed well beyond it."""
    centre, width = BARRIER
    of = scene(even(LEVEL, bumps=((centre, -depth, width), (-centre, -depth, width))), 0.05, 60.0)
    if quantity == "front speed":
        return front(window, of, float(exact_speed(LEVEL, RATIO)), beyond=1.6 * centre)
    run = simulate(of)
    passed = max(0.0, float(path(run)[1][-1]) - centre)
    return Found(0.0, passed, run.attrs["run_flags"], run.attrs["block_updates"])


def printed_sign() -> Found:
    return Found(math.nan, float(run_scene(scene(even(LEVEL), 0.02, 10.0), damping_sign=-1).slip.max()))
