"""Flags of a run: reasons why its numbers are not those of the model.

`flags_of` checks a solution for each of them. The other functions of this module decide single
flags.
"""

import math

import numpy as np

from ..model.friction import COULOMB
from ..model.scene import Scene
from ..model.stability import accurate_step
from ..solver.solution import Solution

# A negative velocity beyond this fraction of the largest velocity shows that a step missed a stick.
# The textbook scheme misses every stick, by the deceleration of one step.
MAX_NEGATIVE_VELOCITY = {"localised": 1e-9, "fixed_step": 1e-2}
# If more than this fraction of the largest energy is missing from the balance, the step is too long
# for the damping.
MAX_ENERGY_RESIDUAL = 1e-2
# A Taylor step is flagged if its relative error in the fastest mode is larger than this. The error
# of front speeds is at most 7 per cent of that error. In chains with rough pre-stress, no front
# speed changed by 2 per cent even at ten times this value.
MAX_STEP_ERROR = 2e-2

# Below this damping ratio, waves of a few blocks do not die out behind a front that the pre-stress
# holds back, even on the finest lattice. Where slip velocity tends to 0 they stop a block within a
# few blocks of the front.
MIN_DAMPING_RATIO_OF_FRONTS = 0.1
MAX_BLOCKS_BEHIND_FRONT = 5
# A front that stood still for longer than this time, in units of H/c, was set in motion again by
# such waves, and small errors decide where it stops. In 885 scenes with rough tables an independent
# solver stopped 6 of 1770 fronts more than two blocks away or with another fate. These fronts had
# stood still for 12 or more, at damping ratios up to 0.02.
MAX_STANDSTILL = 5.0

# Number of positions within the reach of the waves at which the lowest pre-stress is searched for.
PRESTRESS_POSITIONS = 10_001


def flags_of(scene: Scene, solution: Solution) -> dict:
    """Return the blocks across the narrowest pulse, and the flags of a run, separated by commas."""
    blocks, numbers = narrowest_pulse(scene, solution), solution.numbers
    if numbers["releases"] == 0:
        return {"pulse_blocks": blocks, "run_flags": "nothing_released"}
    flags = {
        "reverse_sliding": lowest_stress(scene, solution) <= scene.reverse_threshold,
        "nothing_sticks": nothing_sticks(scene, solution),
        "first_stick_undone": first_stick_undone(scene, solution),
    }
    if scene.scheme == "localised":
        longest = accurate_step(MAX_STEP_ERROR, scene.order, *scene.ratios)
        flags["long_step"] = scene.max_step > longest
    if scene.scheme != "continuum":
        fastest = max(1.0, float(np.max(solution.slip_velocity)))
        lowest_velocity = -MAX_NEGATIVE_VELOCITY[scene.scheme] * fastest
        flags |= {
            "unresolved_pulse": 0 < blocks < scene.resolved_blocks,
            "died_out": died_out(solution),
            "first_stick_at_front": first_stick_at_front(scene, solution),
            "front_restarted": front_restarted(scene, solution),
            "negative_velocity": numbers["min_velocity"] < lowest_velocity,
            # This form of the condition also flags a residual that is NaN.
            "energy": not numbers["energy_residual"] <= MAX_ENERGY_RESIDUAL,
        }
    raised = [name for name, is_raised in flags.items() if is_raised]
    return {"pulse_blocks": blocks, "run_flags": ",".join([*raised, *solution.flags])}


def lowest_stress(scene: Scene, solution: Solution) -> float:
    """Return the lowest stress of a stuck block.

    For an exact solution, return the lowest pre-stress that its waves reach.
    """
    if scene.scheme != "continuum":
        return solution.numbers["min_stuck_stress"]
    first, last = solution.x[0] - scene.duration, solution.x[-1] + scene.duration
    return float(np.min(scene.prestress(np.linspace(first, last, PRESTRESS_POSITIONS))))


def first_stick_undone(scene: Scene, solution: Solution) -> bool:
    """Return True if the first block to stick was released again, as near a slow undamped front."""
    # Under a stress boundary the first stick is not a transition, and the flag has no meaning.
    may_be_undone = scene.boundary == "displacement" and solution.numbers["re_releases"] > 0
    # A later release removes the stick time of a block.
    return may_be_undone and solution.numbers["first_stick_time"] not in solution.stick_time


def first_stick_at_front(scene: Scene, solution: Solution) -> bool:
    """Return True if the first stick may be due to waves of a few blocks just behind a front.

    The front must be held back by negative pre-stress, and the damping must be weak. In the
    continuum another position sticks first, at a later time. Under a stress boundary, only a
    rupture between two negative levels sticks at all.
    """
    numbers, profile = solution.numbers, scene.prestress
    time, position = numbers["first_stick_time"], numbers["first_stick_position"]
    can_stick = scene.boundary == "displacement" or max(profile.left, profile.right) < 0.0
    if scene.damping_ratio >= MIN_DAMPING_RATIO_OF_FRONTS or not can_stick or math.isnan(time):
        return False
    if first_stick_undone(scene, solution):
        return False
    # Distance of the front from x = 0 at the first stick, on the side of this stick.
    side = math.copysign(1.0, position)
    front = np.max(side * solution.x, where=solution.release_time <= time, initial=0.0)
    is_held_back = bool(profile(side * front) < 0.0)
    distance_to_front = front - abs(position)
    return is_held_back and distance_to_front <= MAX_BLOCKS_BEHIND_FRONT * scene.dx


def front_restarted(scene: Scene, solution: Solution) -> bool:
    """Return True if waves of a few blocks may have set a front in motion again.

    The damping must be weak. Only tables of pre-stress are examined: between constant levels, the
    state of the transition shows that a front was delayed.
    """
    if scene.damping_ratio >= MIN_DAMPING_RATIO_OF_FRONTS or not scene.prestress.points:
        return False
    for side in (1, -1):
        # The release times of one side, in order from x = 0 outwards.
        start = np.searchsorted(side * solution.x[::side], 0.0)
        times = solution.release_time[::side][start:]
        waits = np.diff(np.maximum.accumulate(times[np.isfinite(times)]))
        if np.max(waits, initial=0.0) > MAX_STANDSTILL:
            return True
    return False


def nothing_sticks(scene: Scene, solution: Solution) -> bool:
    """Return True if no block stuck in the last 2 pi/sqrt(gamma), the period of the leaf springs.

    Only scenes with leaf springs and another law of friction than that of the paper are flagged.
    """
    if scene.friction == COULOMB or scene.gamma == 0.0:
        return False
    # The slip velocity is NaN where the exact solution does not know it.
    if not np.any(solution.slip_velocity > 0.0) or np.isnan(solution.slip_velocity).any():
        return False
    last = np.max(solution.stick_time, initial=0.0, where=np.isfinite(solution.stick_time))
    return scene.duration - last > 2.0 * math.pi / math.sqrt(scene.gamma)


def narrowest_pulse(scene: Scene, solution: Solution) -> int:
    """Return the number of blocks across the narrowest pulse at the end.

    Under a stress boundary, return the number of blocks across the nucleation. The number is 0
    without a pulse, and if the exact solution does not know the whole state at the end.
    """
    if scene.boundary == "stress":
        return int(_nucleation_width(scene, solution) / scene.dx)
    if np.isnan(solution.slip_velocity).any():
        return 0
    sliding = np.isfinite(solution.release_time) & ~np.isfinite(solution.stick_time)
    edges = np.flatnonzero(np.diff(sliding, prepend=False, append=False))
    lengths = edges[1::2] - edges[0::2]
    # The pulses are the outermost segments. Other segments are remains of the nucleation.
    return int(min(lengths[0], lengths[-1])) if lengths.size else 0


def _nucleation_width(scene: Scene, solution: Solution) -> float:
    """Return the width of the Gaussian at x = 0.

    If the pre-stress falls below 0 at a shorter distance, return that distance.
    """
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
    """Return True if a front stopped although the pre-stress ahead of it is positive."""
    released = np.isfinite(solution.release_time)
    sliding = released & ~np.isfinite(solution.stick_time)
    for side in (1, -1):
        # Look at the blocks of one side, in order from x = 0 outwards.
        start = np.searchsorted(side * solution.x[::side], 0.0)
        reached = np.flatnonzero(released[::side][start:])
        if reached.size and not np.any(sliding[::side][start:]):
            ahead = solution.prestress[::side][start + reached[-1] + 1 :]
            if ahead.size and ahead[0] > 0.0:
                return True
    return False
