"""Flags of a solution: the reasons why its numbers are not those of the model."""

import math

import numpy as np

from ..model.friction import COULOMB
from ..model.scene import Scene
from ..model.stability import accurate_step
from ..solver.solution import Solution

# A velocity this far below zero, as a fraction of the largest, shows a stick that was stepped over.
# The textbook scheme steps over each, by the deceleration of one step.
NEGATIVE_VELOCITY = {"localised": 1e-9, "fixed_step": 1e-2}
# An energy balance that misses this fraction of its largest part shows a step too long for the
# damping.
ENERGY_RESIDUAL = 1e-2
# A Taylor step that errs by this fraction of the fastest mode is flagged. Front speeds err by up to
# 7 per cent of it, and of chains with rough pre-stress none moved by 2 per cent below ten times it.
LONG_STEP = 2e-2

# Below this damping ratio, waves of a few blocks do not die out behind a front that the pre-stress
# holds back, however fine the lattice is. Where slip velocity tends to 0 they stop a block within
# this number of blocks of the front.
WEAK_DAMPING, AT_FRONT = 0.1, 5

# Positions within the reach of waves at which pre-stress is looked at.
REACHED = 10_001


def flags_of(scene: Scene, solution: Solution) -> dict:
    """The blocks across the narrowest pulse, and the names of the flags, separated by commas."""
    blocks, numbers = narrowest_pulse(scene, solution), solution.numbers
    if numbers["releases"] == 0:
        return {"pulse_blocks": blocks, "run_flags": "nothing_released"}
    flags = {
        "reverse_sliding": lowest_stress(scene, solution) <= scene.reverse_threshold,
        "nothing_sticks": nothing_sticks(scene, solution),
        "first_stick_undone": first_stick_undone(scene, solution),
    }
    if scene.scheme == "localised":
        longest = accurate_step(LONG_STEP, scene.order, *scene.ratios)
        flags["long_step"] = scene.max_step > longest
    if scene.scheme != "continuum":
        fastest = max(1.0, float(np.max(solution.slip_velocity)))
        lowest_velocity = -NEGATIVE_VELOCITY[scene.scheme] * fastest
        flags |= {
            "unresolved_pulse": 0 < blocks < scene.resolved_blocks,
            "died_out": died_out(solution),
            "first_stick_at_front": first_stick_at_front(scene, solution),
            "negative_velocity": numbers["min_velocity"] < lowest_velocity,
            # A residual of NaN is flagged, too.
            "energy": not numbers["energy_residual"] <= ENERGY_RESIDUAL,
        }
    names = [*filter(flags.get, flags), *solution.flags]
    return {"pulse_blocks": blocks, "run_flags": ",".join(names)}


def lowest_stress(scene: Scene, solution: Solution) -> float:
    """Lowest stress at rest; of the exact solution, the lowest pre-stress that its waves reach."""
    if scene.scheme != "continuum":
        return solution.numbers["min_stuck_stress"]
    first, last = solution.x[0] - scene.duration, solution.x[-1] + scene.duration
    return float(np.min(scene.prestress(np.linspace(first, last, REACHED))))


def first_stick_undone(scene: Scene, solution: Solution) -> bool:
    """True if the first block to stick was released again, as beside an undamped slow front."""
    # Under a stress boundary the first stick is no transition.
    undone = scene.boundary == "displacement" and solution.numbers["re_releases"] > 0
    return undone and solution.numbers["first_stick_time"] not in solution.stick_time


def first_stick_at_front(scene: Scene, solution: Solution) -> bool:
    """True if waves of a few blocks may have stopped the first block, right behind a slow front.

    In the continuum something else sticks first, and later. Under a stress boundary only a rupture
    between two negative levels sticks at all.
    """
    numbers, profile = solution.numbers, scene.prestress
    time, position = numbers["first_stick_time"], numbers["first_stick_position"]
    sticks = scene.boundary == "displacement" or max(profile.left, profile.right) < 0.0
    if scene.damping_ratio >= WEAK_DAMPING or not sticks or math.isnan(time):
        return False
    if first_stick_undone(scene, solution):
        return False
    side = math.copysign(1.0, position)
    front = np.max(side * solution.x, where=solution.release_time <= time, initial=0.0)
    held_back = bool(profile(side * front) < 0.0)
    return held_back and front - abs(position) <= AT_FRONT * scene.dx


def nothing_sticks(scene: Scene, solution: Solution) -> bool:
    """True if another law of friction than the paper's let nothing stick for 2 pi/sqrt(gamma)."""
    if scene.friction == COULOMB or scene.gamma == 0.0:
        return False
    # The velocity is NaN where the exact solution does not know it.
    if not np.any(solution.slip_velocity > 0.0) or np.isnan(solution.slip_velocity).any():
        return False
    last = np.max(solution.stick_time, initial=0.0, where=np.isfinite(solution.stick_time))
    return scene.duration - last > 2.0 * math.pi / math.sqrt(scene.gamma)


def narrowest_pulse(scene: Scene, solution: Solution) -> int:
    """Blocks across the narrowest pulse at the end; under a stress boundary, across nucleation.

    It is 0 without a pulse, and where the exact solution does not know all of the end.
    """
    if scene.boundary == "stress":
        return int(_nucleation_width(scene, solution) / scene.dx)
    if np.isnan(solution.slip_velocity).any():
        return 0
    sliding = np.isfinite(solution.release_time) & ~np.isfinite(solution.stick_time)
    edges = np.flatnonzero(np.diff(sliding, prepend=False, append=False))
    lengths = edges[1::2] - edges[0::2]
    # The pulses are the outermost segments. Those between them are remains of the nucleation.
    return int(min(lengths[0], lengths[-1])) if lengths.size else 0


def _nucleation_width(scene: Scene, solution: Solution) -> float:
    """Width of the Gaussian at x = 0, or the shorter distance to where the pre-stress turns < 0."""
    profile = scene.prestress
    width = solution.x.size * scene.dx if profile.width is None else profile.width
    if profile.points:
        start = np.argmax(solution.prestress)
        negative = np.abs(np.flatnonzero(solution.prestress < 0.0) - start) * scene.dx
        return float(np.min(negative, initial=width))
    for level in (profile.left, profile.right):
        if level < 0.0 < profile.peak and profile.width is not None:
            width = min(width, profile.width * math.sqrt(2.0 * math.log1p(-profile.peak / level)))
    return width


def died_out(solution: Solution) -> bool:
    """True if a front stands still although the pre-stress ahead of it would drive it on."""
    released = np.isfinite(solution.release_time)
    sliding = released & ~np.isfinite(solution.stick_time)
    for side in (1, -1):
        # The blocks of one side, from x = 0 outwards.
        start = np.searchsorted(side * solution.x[::side], 0.0)
        reached = np.flatnonzero(released[::side][start:])
        if reached.size and not np.any(sliding[::side][start:]):
            ahead = solution.prestress[::side][start + reached[-1] + 1 :]
            if ahead.size and ahead[0] > 0.0:
                return True
    return False
