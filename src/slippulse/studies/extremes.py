"""The edges of the solver's domain: one row an edge, with what should happen and what did."""

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from ..measure.fronts import path
from ..measure.table import measure_run
from ..model.prestress import Prestress
from ..model.scene import Scene
from ..model.stability import MARGIN, largest_step
from ..predict.comparison import pulse_state
from ..simulation.runs import simulate_on_lattice
from ..solver.lattice import UnstableRun
from ..solver.run import run_scene
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import Fronts, exact_transition_displacement
from ..theory.front_speeds import front_speed as exact_speed
from ..theory.front_speeds import lattice_front_speed
from ..theory.pulse import pulse_behind_front

NEEDS = {"settings": ["measure.front_window"]}

# Of every scene that does not say otherwise: a common rupture, so that one number of it at a time is extreme.
GAMMA, LEVEL, RATIO = 0.65, 0.5, 0.1
# Relative errors, absolute where 0 is expected, by family or else quantity; elsewhere equality is asked. What the
# spacings below leave, and for drifts and symmetry what rounding does.
TOLERANCES = {
    "front speed": 0.01, "final slip": 0.05, "T_trans": 0.01, "meeting time": 0.01, "velocity error": 0.01,
    "speed drift": 1e-6, "slip drift": 1e-6, "energy residual": 1e-5, "asymmetry": 1e-9, "negative level": 0.05,
    "step": 0.0,
}  # fmt: skip
# The fraction of a way that never ends, whose time is compared.
FRACTION = 0.95
# Long enough for a drift of rounding to show; two nucleations whose fronts are steady when they meet; centre and width
# of a barrier that a steady pulse meets.
LONG, APART, CENTRE, WIDTH = 1e5, 20.0, 25.0, 2.0
# Of these the steady pulse is expected, so its state belongs to the flags; and flags that say that all is well.
OF_PULSES = ("front speed", "final slip", "speed drift", "slip drift", "energy residual")
FINE = ("", "steady", "none", "resolved")
# Columns of the measured table; the other quantities are found here.
MEASURED = {
    "front speed": "front_speed_right", "final slip": "pulse_slip", "T_trans": "transition_time",
    "energy residual": "energy_residual",
}  # fmt: skip


class Edge(NamedTuple):
    """Family, value at its edge, what is compared, what should happen, the exact value, and keywords for `scene`."""

    family: str
    value: str
    quantity: str
    should: str
    expected: float
    scene: dict[str, Any]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """One row an edge: family, value, quantity, should, tolerance, expected, measured, error, verdict, message (flags
    or the refusal), block_updates.
    """
    return pd.DataFrame([row(edge, settings["measure"]["front_window"]) for edge in edges()])


def edges() -> Iterator[Edge]:
    """Flagged are pulses of fewer blocks than a Scene asks for, fronts with a damped layer that is not thin against the
    pulse, and fronts into negative pre-stress that the lattice stalls or that slide in reverse.
    """
    of: dict[str, Any]
    # Undamped fronts at 7 to 70 wave speeds are exact at any spacing.
    for level in (0.99, 0.999, 0.9999):
        of = {"level": level, "dx": 0.1, "duration": 6.0, "ratio": 0.0}
        yield Edge(
            "level near 1", f"tau_0 = {level:g}", "front speed", "right", speed(level, 0.0), of
        )
    # Pulses narrower than a block, and the same resolved.
    for level, dx, duration, should in (
        (0.05, 0.8, 60.0, "flagged"), (0.05, 0.005, 60.0, "right"), (0.02, 0.4, 60.0, "flagged"),
        (0.02, 0.002, 100.0, "right"), (0.01, 0.4, 60.0, "flagged"), (0.01, 0.01, 60.0, "flagged"),
    ):  # fmt: skip
        of = {"level": level, "dx": dx, "duration": duration, "width": max(0.02, dx)}
        slip = pulse_behind_front(level, GAMMA, RATIO * dx, speed(level)).slip
        yield Edge(
            "level near 0", f"tau_0 = {level:g}, dx = {dx:g}", "final slip", should, slip, of
        )
    # Slip of 1e8, at 500 blocks to 1/sqrt(gamma), the scale of the leaf springs.
    for gamma in (1e-8, 1e-4):
        dx = 1.0 / (500.0 * math.sqrt(gamma))
        yield Edge(
            "gamma", f"gamma = {gamma:g}", "T_trans", "right", *first_stick(dx, 4.0 * dx, gamma)
        )
    # To beyond the largest gamma for which the lattice has a front faster than the waves.
    for gamma in (1.0, 100.0, 1000.0, 6000.0, 1e4, 1e5):
        of = {
            "gamma": gamma,
            "dx": 0.01,
            "duration": 40.0 / math.sqrt(gamma),
            "width": 0.1,
            "ratio": 0.0,
        }
        expected = lattice_front_speed(LEVEL, gamma, 0.01) if gamma < 1e4 else math.nan
        should = "right" if gamma <= 100.0 else "flagged"
        yield Edge(
            "gamma", f"gamma dx^2 = {gamma * 0.01**2:g}", "front speed", should, expected, of
        )
    # The elastic rule meets leaf springs within its damped layer, which must be told.
    for release, ratio, should in (
        ("total", 0.0, "right"), ("total", 1.0, "right"), ("total", 10.0, "right"), ("total", 100.0, "right"),
        ("elastic", 1.0, "right"), ("elastic", 10.0, "flagged"), ("elastic", 100.0, "flagged"),
    ):  # fmt: skip
        # Strong damping under the total rule: a fast front, settled early.
        duration = 40.0 / (1.0 + 0.05 * ratio) if release == "total" else 40.0
        of = {"level": 0.3, "dx": 0.05, "duration": duration, "ratio": ratio, "release": release}
        expected = speed(0.3, ratio, release)
        yield Edge(
            "damping", f"beta/dx = {ratio:g}, {release}", "front speed", should, expected, of
        )
    # One layer thickness to a thousandth.
    for dx, should in ((1.0, "flagged"), (0.3, "right"), (0.1, "right"), (0.01, "right")):
        yield Edge(
            "spacing", f"dx = {dx:g}", "front speed", should, speed(), {"dx": dx, "duration": 60.0}
        )
    for dx in (0.1, 0.01, 1e-3):
        yield Edge("spacing", f"dx = {dx:g}", "T_trans", "right", *first_stick(dx))
    # A peak between two blocks cannot be seen; one block is enough for the front; 1000 layer thicknesses.
    for factor, should in ((0.5, "refused"), (1.0, "right"), (2.0, "right")):
        expected = math.nan if should == "refused" else speed()
        of = {"dx": 0.05, "duration": 20.0, "width": factor * 0.05}
        yield Edge("nucleation", f"W = {factor:g} dx", "front speed", should, expected, of)
    yield Edge("nucleation", "W = 1000", "T_trans", "right", *first_stick(1.0, 1000.0))
    # Reverse sliding from the friction ratio on. Without damping the ringing of the lattice stalls the left front; with
    # it only a coarse lattice does, and that comes late.
    for level, dx, friction, ratio, should in (
        (-1.0, 0.005, 5.0, 0.1, "right"), (-1.0, 0.01, 5.0, 0.0, "flagged"), (-10.0, 0.02, 5.0, 0.1, "flagged"),
        (-10.0, 0.004, 5.0, 0.1, "right"), (-30.0, 0.002, 5.0, 0.1, "flagged"), (-30.0, 0.002, 60.0, 0.1, "right"),
        (-100.0, 0.05, 60.0, 0.1, "flagged"), (-100.0, 0.001, 60.0, 0.1, "right"),
    ):  # fmt: skip
        time = ArrestingCrack(Prestress(level, 0.0), ratio).time_at_fraction(FRACTION)
        of = {
            "level": level,
            "right": 0.0,
            "gamma": 0.0,
            "ratio": ratio,
            "dx": dx,
            "duration": 1.5 * time,
        }
        value = f"tau_l = {level:g}, dx {dx:g}, b {ratio:g}, r {friction:g}"
        yield Edge(
            "negative level", value, "T_trans", should, time, of | {"friction_ratio": friction}
        )
    of = {"dx": 1.0, "duration": LONG, "width": 2.0, "gamma": 0.01}
    for quantity in ("speed drift", "slip drift", "energy residual"):
        yield Edge("duration", f"t = {LONG:g}", quantity, "right", 0.0, of)
    # Parameters in single precision are computed with in double; a state in single precision is not offered.
    of = {"gamma": np.float32(GAMMA), "dx": np.float32(0.1), "ratio": 0.0, "duration": 5.0}
    double = run_scene(scene(**{name: float(value) for name, value in of.items()}))
    yield Edge("float32", "parameters", "slip", "right", float(double.slip.max()), of)
    for gamma in (0.01, 1e-3):
        value = f"state, gamma = {gamma:g}"
        yield Edge("float32", value, "velocity error", "not offered", 0.0, {"gamma": gamma})
    # A hair below the threshold nothing moves; a hair above it all goes as at the threshold.
    for sign, quantity, expected in (("-", "releases", 0.0), ("+", "front speed", speed())):
        for apart in (1e-9, 1e-3):
            of = {"peak": 1.0 + float(f"{sign}{apart}"), "dx": 0.05, "duration": 30.0}
            yield Edge("peak", f"1 {sign} {apart:g}", quantity, "right", expected, of)
    # The fronts of two equal peaks meet halfway, at the time that one of them takes to get there.
    exact = float(Fronts(Prestress(LEVEL, LEVEL), RATIO, "total", APART).arrival(0.5 * APART))
    for quantity, expected, factor in (("meeting time", exact, 1.5), ("asymmetry", 0.0, 3.0)):
        of = {"bumps": ((APART, 1.0 - LEVEL, 1.0),), "dx": 0.02, "duration": factor * exact}
        yield Edge("two nucleations", f"{APART:g} apart", quantity, "right", expected, of)
    # A deep barrier of negative pre-stress stops the pulse, a shallow one only slows it.
    for depth, quantity, expected in ((1.5, "passes by", 0.0), (0.2, "front speed", speed())):
        of = {
            "bumps": ((CENTRE, -depth, WIDTH), (-CENTRE, -depth, WIDTH)),
            "dx": 0.05,
            "duration": 60.0,
        }
        yield Edge("barrier", f"depth {depth:g}", quantity, "right", expected, of)
    # The damping term as the paper prints it feeds the grid modes.
    yield Edge(
        "damping sign", "as printed", "slip", "stopped", math.nan, {"dx": 0.02, "duration": 10.0}
    )
    for scheme in ("localised", "fixed_step"):
        of = {"dx": 0.1, "duration": 10.0, "scheme": scheme, "max_step": 3.0}
        yield Edge("step", f"3 dx, {scheme}", "front speed", "refused", math.nan, of)


def speed(level: float = LEVEL, ratio: float = RATIO, release: str = "total") -> float:
    return float(exact_speed(level, ratio, release))


def first_stick(
    dx: float, width: float = 1.0, gamma: float = GAMMA
) -> tuple[float, dict[str, Any]]:
    """T_trans of the continuum, and a scene that just reaches it."""
    exact = exact_transition_displacement(Prestress(LEVEL, LEVEL, width), gamma, RATIO).time
    return exact, {"dx": dx, "duration": 1.02 * exact + 4.0 * dx, "width": width, "gamma": gamma}


def scene(
    dx: float, duration: float, level: float = LEVEL, right: float | None = None, width: float = 1.0, peak: float = 1.0,
    bumps: Any = (), ratio: float = RATIO, gamma: float = GAMMA, **more: Any,
) -> Scene:  # fmt: skip
    """A scene under the displacement boundary, or under the stress boundary when gamma is 0."""
    profile = Prestress(level, level if right is None else right, width, peak, bumps=bumps)
    step = min(0.5, MARGIN * largest_step("localised", 4, ratio, gamma * dx**2))
    boundary = "displacement" if gamma > 0.0 else "stress"
    return Scene(boundary, profile, duration, dx, gamma, ratio * dx, **{"max_step": step} | more)


def row(edge: Edge, window: float) -> dict[str, Any]:
    """Run an edge and judge it: a flag wins; then a number that is missing; then the number itself."""
    tolerance = TOLERANCES.get(edge.family, TOLERANCES.get(edge.quantity, 0.0))
    value, message, updates, ended = math.nan, "", 0, ""
    try:
        value, message, updates = measured(edge, window)
    except (UnstableRun, ValueError) as error:
        ended, message = "stopped" if isinstance(error, UnstableRun) else "refused", str(error)
    off = abs(value - edge.expected) / (abs(edge.expected) or 1.0)
    # Comparisons with NaN are False: a number where theory has none is wrong unless it was flagged.
    judged = (
        "no number"
        if math.isnan(value)
        else "right"
        if off <= tolerance
        else "WRONG WITHOUT A FLAG"
    )
    flagged = message if message == "not offered" else message and "flagged"
    return {
        "family": edge.family, "value": edge.value, "quantity": edge.quantity, "should": edge.should,
        "tolerance": tolerance, "expected": edge.expected, "measured": value, "error": off,
        "verdict": ended or flagged or judged, "message": message, "block_updates": updates,
    }  # fmt: skip


# Three edges are of the longest run.
simulated = lru_cache(maxsize=1)(simulate_on_lattice)


def measured(edge: Edge, window: float) -> tuple[float, str, int]:
    """What was found at an edge, flags, and block updates; raises what a refused scene or a stopped run raises."""
    if edge.quantity == "velocity error":
        return single_precision_error(edge.scene["gamma"]), "not offered", 0
    of = scene(**edge.scene)
    if edge.quantity == "slip":
        return (
            float(
                run_scene(of, damping_sign=-1 if edge.family == "damping sign" else 1).slip.max()
            ),
            "",
            0,
        )
    run = simulated(of)
    numbers, pulse = measure_run(
        run, {"front_window": window, "share": FRACTION, "trailing_times": ()}
    )
    flags = [numbers["run_flags"], numbers.get("transition_state", "")]
    if pulse is not None and edge.quantity in OF_PULSES:
        flags.append(pulse_state(run, pulse))
    x, slip = run["x"].values, run["slip"].values
    match edge.quantity:
        case "releases":
            # That nothing is released is flagged, and right here.
            value, flags = float(run.attrs["releases"]), []
        case "speed drift" | "slip drift":
            value = drift(run, edge.quantity)
        case "meeting time":
            value = float(
                np.nanmax(run["release_time"].values[np.abs(x - 0.5 * APART) < 1.5 * of.dx])
            )
        case "asymmetry":
            mirrored = np.interp(APART - x, x, slip, left=0.0, right=0.0)
            value = float(np.max(np.abs(slip - mirrored)) / slip.max())
        case "passes by":
            value = max(0.0, float(path(run)[1][-1]) - CENTRE)
        case quantity:
            value = numbers[MEASURED[quantity]]
    return value, ",".join(flag for flag in flags if flag not in FINE), run.attrs["block_updates"]


def drift(run: xr.Dataset, quantity: str) -> float:
    """Relative change of the front speed, or of the slip behind it, between a fifth and nine tenths of the path."""
    times, distances = path(run)
    x, far, found = run["x"].values, distances[-1], []
    for start, end in ((0.2, 0.3), (0.9, 1.0)):
        part = (distances > start * far) & (distances < end * far)
        if quantity == "speed drift":
            found.append(np.polyfit(times[part], distances[part], 1)[0])
        else:
            found.append(np.mean(run["slip"].values[(x > start * far) & (x < (end - 0.01) * far)]))
    return float(found[1] / found[0] - 1.0)


def single_precision_error(gamma: float) -> float:
    """What a state in float32 would cost, against float64: slip velocity of a crack from a Gaussian of W = 8 dx, by
    symplectic Euler on slip, the force from second differences of slip; no damping.
    """
    dx, step, duration = 0.1, 0.4 * 0.1, 0.9 * math.pi / math.sqrt(gamma)
    x, found = dx * np.arange(int(1.5 * duration / dx) + 32), []
    tau = LEVEL + (1.0 - LEVEL) * np.exp(-0.5 * (x / (8.0 * dx)) ** 2)
    for dtype in (np.float64, np.float32):
        # A plain number takes the type of the array that it meets.
        stress: np.ndarray = tau.astype(dtype)
        slip, velocity, force, sliding = *np.zeros((3, x.size), dtype), stress >= 1.0
        for _ in range(round(duration / step)):
            force[1:-1] = 1.0 / dx**2 * (slip[2:] - 2.0 * slip[1:-1] + slip[:-2])
            force[0] = 2.0 / dx**2 * (slip[1] - slip[0])
            force[:-1] += stress[:-1] - gamma * slip[:-1]
            sliding |= force >= 1.0
            velocity = np.where(sliding, np.maximum(velocity + step * force, 0.0), 0.0)
            slip += step * velocity
        found.append(velocity)
    return float(np.max(np.abs(found[0] - found[1])) / np.max(found[0]))
