"""Flags of a run: reasons why its numbers are not those of the model.

`flags_of` checks a solution for each of them. The other functions of this module decide single
flags.
"""

import math

import numpy as np

from ..measurement.nucleation import nucleation_position
from ..model.friction import COULOMB
from ..model.scene import Scene
from ..model.stability import accurate_step
from ..solver.solution import Solution

# A velocity that is more negative than this fraction of the largest velocity shows that a step
# missed a stick. The textbook scheme misses every stick, but only by the deceleration of one step.
MAX_NEGATIVE_VELOCITY = {"localised": 1e-9, "fixed_step": 1e-2}
# If more than this fraction of the largest energy is missing from the balance, the step is too long
# for the damping.
MAX_ENERGY_RESIDUAL = 1e-2
# A Taylor step is flagged if its relative error in the fastest mode is larger than this. The error
# of front speeds is at most 7 per cent of that error. In chains with rough pre-stress, no front
# speed changed by 2 per cent even at ten times this value.
MAX_STEP_ERROR = 2e-2

# Below this damping ratio, waves of a few blocks do not die out behind a front that negative
# pre-stress holds back, even on the finest lattice. The slip velocity is small near such a front,
# so that these waves can stop a block. This block is at most a few blocks behind the front.
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
    """Return the attributes ``pulse_blocks`` and ``run_flags`` of a run.

    These attributes are the number of blocks across the narrowest pulse, and the flags separated by
    commas.
    """
    blocks = blocks_across_narrowest_pulse(scene, solution)
    numbers = solution.numbers
    if numbers["releases"] == 0:
        return {"pulse_blocks": blocks, "run_flags": "nothing_released"}
    flags = {
        "reverse_sliding": lowest_stress(scene, solution) <= scene.reverse_threshold,
        "nothing_sticks": nothing_sticks(scene, solution),
        "first_stick_undone": first_stick_undone(scene, solution),
    }
    if scene.scheme == "localised":
        # The error of a step depends on its order, and on ratios such as the damping ratio.
        longest_step = accurate_step(MAX_STEP_ERROR, scene.order, *scene.ratios)
        flags["long_step"] = scene.max_step > longest_step
    if scene.scheme != "continuum":
        largest_velocity = max(1.0, float(np.max(solution.slip_velocity)))
        lowest_allowed = -MAX_NEGATIVE_VELOCITY[scene.scheme] * largest_velocity
        flags |= {
            # No blocks means that there is no pulse.
            "unresolved_pulse": 0 < blocks < scene.resolved_blocks,
            "died_out": died_out(solution),
            "first_stick_at_front": first_stick_at_front(scene, solution),
            "front_restarted": front_restarted(scene, solution),
            "negative_velocity": numbers["min_velocity"] < lowest_allowed,
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
    # Waves have the speed 1, so that they run this far beyond the positions of the solution.
    distance = scene.duration
    first, last = solution.x[0] - distance, solution.x[-1] + distance
    positions = np.linspace(first, last, PRESTRESS_POSITIONS)
    return float(np.min(scene.prestress(positions)))


def first_stick_undone(scene: Scene, solution: Solution) -> bool:
    """Return True if the first block to stick was released again.

    Such a release happens near a slow undamped front. Under a stress boundary the first stick is
    not a transition, so that the flag has no meaning and the result is False.
    """
    may_be_undone = scene.boundary == "displacement" and solution.numbers["re_releases"] > 0
    # A later release removes the stick time of a block.
    return may_be_undone and solution.numbers["first_stick_time"] not in solution.stick_time


def first_stick_at_front(scene: Scene, solution: Solution) -> bool:
    """Return True if the first stick may be due to waves of a few blocks just behind a front.

    Such waves are possible if the front is held back by negative pre-stress, and if the damping is
    weak. In the continuum limit another position sticks first, at a later time. Under a stress
    boundary, only a rupture between two negative levels sticks at all. A first stick that was
    undone has a flag of its own.
    """
    numbers, profile = solution.numbers, scene.prestress
    time, position = numbers["first_stick_time"], numbers["first_stick_position"]
    can_stick = scene.boundary == "displacement" or max(profile.left, profile.right) < 0.0
    if not can_stick or math.isnan(time) or first_stick_undone(scene, solution):
        return False
    if scene.damping_ratio >= MIN_DAMPING_RATIO_OF_FRONTS:
        return False
    start = _nucleation_position(solution)
    # Side on which the first block sticks: -1 for the left, 1 for the right.
    side = math.copysign(1.0, position - start)
    # Distance of the front on this side from the nucleation, at the time of the first stick.
    is_released = solution.release_time <= time
    front_distance = np.max(side * (solution.x - start), where=is_released, initial=0.0)
    is_held_back = bool(profile(start + side * front_distance) < 0.0)
    distance_to_front = front_distance - abs(position - start)
    return is_held_back and distance_to_front <= MAX_BLOCKS_BEHIND_FRONT * scene.dx


def front_restarted(scene: Scene, solution: Solution) -> bool:
    """Return True if waves of a few blocks may have set a front in motion again.

    Such a restart is possible if the damping is weak, and the front has stood still for long. Only
    tables of pre-stress are examined. For constant levels under a stress boundary,
    `slippulse.measure` returns the transition state "stalled" if the lattice held up the front.
    """
    if scene.damping_ratio >= MIN_DAMPING_RATIO_OF_FRONTS or not scene.prestress.points:
        return False
    for side in (1, -1):
        release_times = _values_outwards(solution, solution.release_time, side)
        released = release_times[np.isfinite(release_times)]
        # The front reaches a block when this block and all blocks before it have been released.
        arrival_times = np.maximum.accumulate(released)
        if np.max(np.diff(arrival_times), initial=0.0) > MAX_STANDSTILL:
            return True
    return False


def nothing_sticks(scene: Scene, solution: Solution) -> bool:
    """Return True if no block stuck in the last 2 pi/sqrt(gamma), the period of the leaf springs.

    Under another law than that of the paper, leaf springs may never stop the blocks, so that the
    rupture stays a crack. Other scenes are not flagged.
    """
    if scene.friction == COULOMB or scene.gamma == 0.0:
        return False
    # The slip velocity is NaN where the exact solution does not know it.
    if not np.any(solution.slip_velocity > 0.0) or np.isnan(solution.slip_velocity).any():
        return False
    has_stuck = np.isfinite(solution.stick_time)
    last_stick = np.max(solution.stick_time, initial=0.0, where=has_stuck)
    return scene.duration - last_stick > 2.0 * math.pi / math.sqrt(scene.gamma)


def blocks_across_narrowest_pulse(scene: Scene, solution: Solution) -> int:
    """Return the number of blocks across the narrowest pulse at the end.

    Under a stress boundary, return the number of blocks across the nucleation, at least 1: without
    leaf springs, nothing else sets a length. Otherwise the number is 0 if there is no pulse, or if
    the exact solution does not know the whole state at the end (its slip velocity is then NaN).
    """
    if scene.boundary == "stress":
        return max(int(_nucleation_width(scene, solution) / scene.dx), 1)
    if np.isnan(solution.slip_velocity).any():
        return 0
    is_sliding = np.isfinite(solution.release_time) & ~np.isfinite(solution.stick_time)
    # The first block of each segment of sliding blocks, and the block after its last one.
    edges = np.flatnonzero(np.diff(is_sliding, prepend=False, append=False))
    lengths = edges[1::2] - edges[0::2]
    # The pulses are the outermost segments. Other segments are remains of the nucleation.
    return int(min(lengths[0], lengths[-1])) if lengths.size else 0


def _nucleation_width(scene: Scene, solution: Solution) -> float:
    """Return the distance over which the pre-stress of the nucleation falls off.

    This distance is the width of the Gaussian at x = 0. If the pre-stress falls below 0 at a
    shorter distance, it is that distance. Without a Gaussian, the length of the whole solution
    takes the place of the width.
    """
    profile, dx = scene.prestress, scene.dx
    width = solution.x.size * dx if profile.width is None else profile.width
    # In a table of pre-stress, search for the negative block that is nearest to the highest one.
    if profile.points:
        # If several neighbouring blocks are highest, the distance is measured from their middle.
        highest_block = int(np.argmax(solution.prestress))
        is_highest = solution.prestress == solution.prestress[highest_block]
        highest_count = np.argmin(np.append(is_highest[highest_block:], False))
        middle = highest_block + 0.5 * (highest_count - 1)
        negative_blocks = np.flatnonzero(solution.prestress < 0.0)
        distances = np.abs(negative_blocks - middle) * dx
        return float(np.min(distances, initial=width))
    if profile.width is None:
        return width
    # Otherwise, the Gaussian falls to a level on each side.
    for level in (profile.left, profile.right):
        if level < 0.0 < profile.peak:
            # Where level + (peak - level) exp(-x^2 / 2 width^2) is 0.
            distance = profile.width * math.sqrt(2.0 * math.log1p(-profile.peak / level))
            width = min(width, distance)
    return width


def died_out(solution: Solution) -> bool:
    """Return True if a front stopped although the pre-stress ahead of it is positive.

    A front has stopped if no block on its side of the nucleation slides at the end.
    """
    is_released = np.isfinite(solution.release_time)
    is_sliding = is_released & ~np.isfinite(solution.stick_time)
    for side in (1, -1):
        released_blocks = np.flatnonzero(_values_outwards(solution, is_released, side))
        has_stopped = not np.any(_values_outwards(solution, is_sliding, side))
        if released_blocks.size and has_stopped:
            first_ahead = released_blocks[-1] + 1
            prestress_ahead = _values_outwards(solution, solution.prestress, side)[first_ahead:]
            if prestress_ahead.size and prestress_ahead[0] > 0.0:
                return True
    return False


def _values_outwards(solution: Solution, values: np.ndarray, side: int) -> np.ndarray:
    """Return the values of the blocks on one side, in order from the nucleation outwards.

    side : 1 for the right side and -1 for the left one
    """
    distances = side * (solution.x - _nucleation_position(solution))[::side]
    first = np.searchsorted(distances, 0.0)
    return values[::side][first:]


def _nucleation_position(solution: Solution) -> float:
    """Return the position at which the rupture starts; 0 if it starts at several places."""
    return nucleation_position(solution.x, solution.prestress, solution.release_time)
