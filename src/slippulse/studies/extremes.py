"""The edges of the solver's domain: one row an edge, with what should happen and what did."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from functools import lru_cache, partial

import numpy as np
import pandas as pd

from ..measure.fronts import front_speed, path
from ..measure.pulses import leading_pulse
from ..measure.transition import STALL, transition_stress
from ..model.prestress import Prestress
from ..simulation.simulate import simulate
from ..solver.run import run_scene
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import Fronts, exact_transition_displacement
from ..theory.front_law import front_speed as exact_speed
from ..theory.front_law import lattice_front_speed
from ..theory.pulse import SteadyPulse, steady_pulse
from .edges import Edge, Measured, flags_of, scene, speed
from .outcomes import NOT_OFFERED
from .single_precision import crack_velocity

# What it is made from besides its own section of `studies`.
NEEDS = {"settings": ["measure.front_window"]}

GAMMA, LEVEL, RATIO = 0.65, 0.5, 0.1


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Run every edge.

    Parameters
    ----------
    settings : `studies.extremes` of the configuration, and front_window

    Returns
    -------
    one row an edge: family, value, quantity, should, tolerance, expected, measured, error, verdict, message (flags or
    the refusal), block_updates
    """
    families = (
        near_one, near_zero, elasticity, damping, spacing, nucleation_width, negative_level, long_run, precision,
        peak, two_nucleations, barrier, printed_sign, beyond_the_bound,
    )  # fmt: skip
    window, tolerances = settings["measure"]["front_window"], settings["tolerances"]
    edges = [edge for family in families for edge in family(settings, window, tolerances)]
    return pd.DataFrame([edge.row() for edge in edges])


def even(level: float, width: float = 1.0, **more) -> Prestress:
    """The same level on both sides."""
    return Prestress(level, level, width, **more)


def near_one(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """Fronts at 7 to 70 wave speeds, undamped: exact at any spacing."""
    rule = settings["level_near_one"]
    for level in rule["levels"]:
        of = scene(even(level), GAMMA, 0.0, rule["dx"], rule["duration"])
        yield Edge(
            "level near 1", f"tau_0 = {level:g}", "front speed", "right", tolerances["front_speed"],
            partial(speed, of, float(exact_speed(level, 0.0)), window),
        )  # fmt: skip


def near_zero(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """Pulses narrower than a block, and the same resolved."""
    rule = settings["level_near_zero"]
    for level, dx, duration in rule["level_dx_duration"]:
        of = scene(even(level, max(rule["width"], dx)), GAMMA, RATIO, dx, duration)
        pulse = steady_pulse(level, GAMMA, of.beta, float(exact_speed(level, RATIO)))
        sound = pulse.width >= of.resolved_blocks * dx and thin_front(of.beta, pulse)

        def slip(of=of, pulse=pulse) -> Measured:
            run = simulate(of)
            found = leading_pulse(run, window).slip
            return Measured(pulse.slip, found, flags_of(run, window), run.attrs["block_updates"])

        yield Edge(
            "level near 0", f"tau_0 = {level:g}, dx = {dx:g}", "final slip", "right" if sound else "flagged",
            tolerances["final_slip"], slip,
        )  # fmt: skip


def thin_front(beta: float, pulse: SteadyPulse) -> bool:
    """Whether the damped layer at the front is thin against the pulse, by exact speed and width."""
    return beta * pulse.speed / (pulse.speed**2 - 1.0) < 0.1 * pulse.width


def elasticity(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """From slip of 1e8 to beyond the largest gamma for which the lattice has a front faster than the waves."""
    rule = settings["gamma"]
    for gamma in rule["small"]:
        # The scale is that of the leaf springs: 1500 blocks to 1/sqrt(gamma).
        dx = 1.0 / (500.0 * math.sqrt(gamma))
        profile = even(LEVEL, 4.0 * dx)
        yield Edge(
            "gamma", f"gamma = {gamma:g}", "T_trans", "right", tolerances["transition_time"],
            partial(first_stick, profile, gamma, dx),
        )  # fmt: skip
    for gamma in rule["large"]:
        of = scene(even(LEVEL, 10.0 * rule["dx"]), gamma, 0.0, rule["dx"], 40.0 / math.sqrt(gamma))
        try:
            expected = lattice_front_speed(LEVEL, gamma, of.dx)
        except ValueError:
            expected = math.nan
        blocks = steady_pulse(LEVEL, gamma, 0.0, expected).width / of.dx if expected > 1.0 else 0.0
        yield Edge(
            "gamma", f"gamma dx^2 = {gamma * of.dx**2:g}", "front speed",
            "right" if blocks >= of.resolved_blocks else "flagged", tolerances["front_speed"],
            partial(speed, of, expected, window),
        )  # fmt: skip


def first_stick(profile: Prestress, gamma: float, dx: float, ratio: float = RATIO) -> Measured:
    """T_trans against the continuum's."""
    exact = exact_transition_displacement(profile, gamma, ratio).time
    run = simulate(scene(profile, gamma, ratio, dx, 1.02 * exact + 4.0 * dx))
    found = run.attrs["first_stick_time"]
    return Measured(exact, found, run.attrs["run_flags"], run.attrs["block_updates"])


def damping(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """beta/dx from 0 to 100; the elastic rule meets leaf springs within its damped layer, which must be told."""
    rule = settings["damping_ratio"]
    for release, ratios in (("total", rule["total"]), ("elastic", rule["elastic"])):
        for ratio in ratios:
            more = {"release": release}
            # Strong damping under the total rule: a fast front, settled early.
            duration = rule["duration"] / (1.0 + 0.05 * ratio) if release == "total" else rule["duration"]
            of = scene(even(rule["level"]), GAMMA, ratio, rule["dx"], duration, **more)
            expected = float(exact_speed(rule["level"], ratio, release))
            thin = thin_front(of.beta, steady_pulse(rule["level"], GAMMA, of.beta, expected))
            yield Edge(
                "damping", f"beta/dx = {ratio:g}, {release}", "front speed", "right" if thin else "flagged",
                tolerances["front_speed"], partial(speed, of, expected, window),
            )  # fmt: skip


def spacing(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """dx from one layer thickness to a thousandth."""
    rule = settings["dx"]
    for dx in rule["pulse"]:
        of = scene(even(LEVEL), GAMMA, RATIO, dx, rule["duration"])
        width = steady_pulse(LEVEL, GAMMA, of.beta, float(exact_speed(LEVEL, RATIO))).width
        yield Edge(
            "spacing", f"dx = {dx:g}", "front speed", "right" if width >= of.resolved_blocks * dx else "flagged",
            tolerances["front_speed"], partial(speed, of, float(exact_speed(LEVEL, RATIO)), window),
        )  # fmt: skip
    for dx in rule["transition"]:
        yield Edge(
            "spacing", f"dx = {dx:g}", "T_trans", "right", tolerances["transition_time"],
            partial(first_stick, even(LEVEL), GAMMA, dx),
        )  # fmt: skip


def nucleation_width(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """A peak between two blocks cannot be seen; one block is enough for the front; 1000 layer thicknesses."""
    rule = settings["width"]

    def narrow(factor: float) -> Measured:
        of = scene(even(LEVEL, factor * rule["dx"]), GAMMA, RATIO, rule["dx"], rule["duration"])
        return speed(of, float(exact_speed(LEVEL, RATIO)), window)

    for factor in rule["blocks"]:
        yield Edge(
            "nucleation", f"W = {factor:g} dx", "front speed", "right" if factor >= 1.0 else "refused",
            tolerances["front_speed"], partial(narrow, factor),
        )  # fmt: skip
    for width in rule["wide"]:
        yield Edge(
            "nucleation", f"W = {width:g}", "T_trans", "right", tolerances["transition_time"],
            partial(first_stick, even(LEVEL, width), GAMMA, rule["dx"] * max(1.0, 0.001 * width / rule["dx"])),
        )  # fmt: skip


def negative_level(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """Levels down to -100 under a stress boundary: reverse sliding, a front that the lattice stalls, the right time."""
    rule = settings["negative_level"]
    for level, dx, friction_ratio, ratio in rule["level_dx_friction_ratio_damping"]:
        profile = Prestress(level, 0.0)
        of = scene(profile, 0.0, ratio, dx, 1.0, friction_ratio=friction_ratio)
        crack = ArrestingCrack(profile, ratio)
        time = crack.share_time(rule["share"])
        distance = abs(crack.balance_position)
        # Without damping the ringing of the lattice stalls the left front; with it only a coarse lattice does.
        smooth = (
            (time - crack.share_time(rule["share"] - dx / distance)) / time if dx < distance else math.inf
        )
        sound = level > of.reverse_threshold and ratio > 0.0 and smooth <= STALL

        def covered(of=of, profile=profile, ratio=ratio, time=time) -> Measured:
            # A coarse lattice comes late.
            run = simulate(scene(profile, 0.0, ratio, of.dx, 1.5 * time, friction_ratio=of.friction_ratio))
            found = transition_stress(run, rule["share"])
            state = found["transition_state"]
            flags = [run.attrs["run_flags"], state if state != "resolved" else ""]
            flags = ",".join(flag for flag in flags if flag)
            return Measured(time, found["transition_time"], flags, run.attrs["block_updates"])

        yield Edge(
            "negative level", f"tau_l = {level:g}, dx {dx:g}, b {ratio:g}, r {friction_ratio:g}", "T_trans",
            "right" if sound else "flagged", tolerances["share_time"], covered,
        )  # fmt: skip


def long_run(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """A pulse over a long time: speed, slip and energy must not drift."""
    rule = settings["long_run"]

    @lru_cache(maxsize=1)
    def drifts() -> tuple[dict[str, float], str, int]:
        of = scene(even(LEVEL, 2.0), rule["gamma"], RATIO, 1.0, rule["duration"])
        run = simulate(of)
        times, distances = path(run)
        speeds, slips = [], []
        for start, end in ((0.2, 0.3), (0.9, 1.0)):
            part = (distances > start * distances[-1]) & (distances < end * distances[-1])
            speeds.append(np.polyfit(times[part], distances[part], 1)[0])
            behind = (run["x"].values > start * distances[-1]) & (
                run["x"].values < (end - 0.01) * distances[-1]
            )
            slips.append(float(np.mean(run["slip"].values[behind])))
        found = {
            "speed drift": speeds[1] / speeds[0] - 1.0,
            "slip drift": slips[1] / slips[0] - 1.0,
            "energy residual": run.attrs["energy_residual"],
        }
        return found, flags_of(run, window), run.attrs["block_updates"]

    def drift(quantity: str) -> Measured:
        found, flags, updates = drifts()
        return Measured(0.0, float(found[quantity]), flags, updates)

    for quantity in ("speed drift", "slip drift", "energy residual"):
        yield Edge(
            "duration", f"t = {rule['duration']:g}", quantity, "right", tolerances[quantity.replace(" ", "_")],
            partial(drift, quantity),
        )  # fmt: skip


def precision(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """float32 parameters are computed with in double; float32 state is not offered, and what it would cost."""
    rule = settings["float32"]

    def parameters() -> Measured:
        single = scene(even(LEVEL), np.float32(GAMMA), 0.0, np.float32(0.1), 5.0)
        double = scene(even(LEVEL), float(np.float32(GAMMA)), 0.0, float(np.float32(0.1)), 5.0)
        slips = [float(run_scene(of).slip.max()) for of in (double, single)]
        return Measured(*slips)

    def state(gamma: float) -> Measured:
        values = (gamma, LEVEL, rule["dx"], 0.9 * math.pi / math.sqrt(gamma), 0.4)
        double, single = (crack_velocity(*values, kind) for kind in (np.float64, np.float32))
        off = float(np.max(np.abs(double - single)) / np.max(double))
        return Measured(0.0, off, NOT_OFFERED)

    yield Edge("float32", "parameters", "slip", "right", 0.0, parameters)
    for gamma in rule["gamma"]:
        yield Edge(
            "float32", f"state, gamma = {gamma:g}", "velocity error", "not offered", tolerances["front_speed"],
            partial(state, gamma),
        )  # fmt: skip


def peak(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """A hair below the threshold nothing moves; a hair above it all goes as at the threshold."""
    rule = settings["peak"]

    def released(value: float) -> Measured:
        run = simulate(scene(even(LEVEL, peak=value), GAMMA, RATIO, rule["dx"], rule["duration"]))
        # That nothing is released is flagged, and right here.
        flags = run.attrs["run_flags"].replace("nothing_released", "")
        return Measured(0.0, float(run.attrs["releases"]), flags, run.attrs["block_updates"])

    for below in rule["apart"]:
        yield Edge("peak", f"1 - {below:g}", "releases", "right", 0.0, partial(released, 1.0 - below))
    for above in rule["apart"]:
        of = scene(even(LEVEL, peak=1.0 + above), GAMMA, RATIO, rule["dx"], rule["duration"])
        yield Edge(
            "peak", f"1 + {above:g}", "front speed", "right", tolerances["front_speed"],
            partial(speed, of, float(exact_speed(LEVEL, RATIO)), window),
        )  # fmt: skip


def two_nucleations(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """Two equal peaks: their fronts meet halfway, at the time that one of them takes to get there."""
    rule = settings["two_nucleations"]
    distance, dx = rule["distance"], rule["dx"]
    profile = even(LEVEL, bumps=((distance, 1.0 - LEVEL, 1.0),))
    exact = float(Fronts(even(LEVEL), RATIO, "total", distance).arrival(np.array([0.5 * distance]))[0])

    def meeting() -> Measured:
        run = simulate(scene(profile, GAMMA, RATIO, dx, 1.5 * exact))
        between = np.abs(run["x"].values - 0.5 * distance) < 1.5 * dx
        found = float(np.nanmax(run["release_time"].values[between]))
        return Measured(exact, found, run.attrs["run_flags"], run.attrs["block_updates"])

    def asymmetry() -> Measured:
        run = simulate(scene(profile, GAMMA, RATIO, dx, 3.0 * exact))
        x, slip = run["x"].values, run["slip"].values
        mirrored = np.interp(distance - x, x, slip, left=0.0, right=0.0)
        off = float(np.max(np.abs(slip - mirrored)) / slip.max())
        return Measured(0.0, off, run.attrs["run_flags"], run.attrs["block_updates"])

    yield Edge(
        "two nucleations",
        f"{distance:g} apart",
        "meeting time",
        "right",
        tolerances["transition_time"],
        meeting,
    )
    yield Edge(
        "two nucleations", f"{distance:g} apart", "asymmetry", "right", tolerances["asymmetry"], asymmetry
    )


def barrier(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """Negative pre-stress in the way: a deep barrier stops the pulse, a shallow one only slows it."""
    rule = settings["barrier"]
    dx, centre, width = rule["dx"], rule["centre"], rule["width"]

    def beyond(depth: float) -> Measured:
        profile = even(LEVEL, bumps=((centre, -depth, width), (-centre, -depth, width)))
        run = simulate(scene(profile, GAMMA, RATIO, dx, rule["duration"]))
        _, distances = path(run)
        return Measured(
            0.0, max(0.0, float(distances[-1]) - centre), run.attrs["run_flags"], run.attrs["block_updates"]
        )

    def after(depth: float) -> Measured:
        profile = even(LEVEL, bumps=((centre, -depth, width), (-centre, -depth, width)))
        of = scene(profile, GAMMA, RATIO, dx, rule["duration"])
        return speed(of, float(exact_speed(LEVEL, RATIO)), window, beyond=1.6 * centre)

    for depth in rule["deep"]:
        yield Edge("barrier", f"depth {depth:g}", "passes by", "right", 0.0, partial(beyond, depth))
    for depth in rule["shallow"]:
        yield Edge(
            "barrier",
            f"depth {depth:g}",
            "front speed",
            "right",
            tolerances["front_speed"],
            partial(after, depth),
        )


def printed_sign(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """The damping term as the paper prints it feeds the grid modes: the run must be stopped."""

    def run() -> Measured:
        found = run_scene(scene(even(LEVEL), GAMMA, RATIO, 0.02, 10.0), damping_sign=-1)
        return Measured(math.nan, float(found.slip.max()))

    yield Edge("damping sign", "as printed", "slip", "stopped", 0.0, run)


def beyond_the_bound(settings: Mapping, window: float, tolerances: Mapping) -> Iterator[Edge]:
    """A step beyond the stability bound is refused, whatever the scheme."""

    def run(scheme: str) -> Measured:
        of = scene(even(LEVEL), GAMMA, RATIO, 0.1, 10.0, scheme=scheme, max_step=3.0)
        return Measured(math.nan, front_speed(simulate(of), window)[0])

    for scheme in ("localised", "fixed_step"):
        yield Edge("step", f"3 dx, {scheme}", "front speed", "refused", 0.0, partial(run, scheme))
