"""The textbook scheme, for comparison: symplectic Euler, with events checked once per step.

Each step computes the forces, advances the velocities with them, and then the slip with the new
velocities. A block is released or stopped at the step at which its stress or velocity passes the
threshold. The scheme is of first order in the step. Its front speed can lock to dx/(n dt) with an
integer n. Arguments such as ``medium``, ``motion`` and ``tally`` are groups of numbers and arrays,
which `arrays` defines.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
from numba.extending import register_jitable

from ..model.friction import LAWS
from ..model.friction_laws.law import Friction
from ..model.samples import Samples
from ..model.scene import Scene
from .arrays import (
    ACCELERATION,
    ALL_STUCK,
    BLOWN_UP,
    EDGE_BLOCKS,
    END_REACHED,
    LATTICE_TOO_SHORT,
    SLIP,
    STEPS_DONE,
    VELOCITY,
    Limits,
)
from .jit import kernel_entry, kernel_function
from .lattice import Lattice
from .solution import Solution, solve_on_lattice
from .taylor import BLOW_UP_FACTOR, next_step, record_release, record_stick

# A front is locked to a fraction of dx/dt if it repeats the same cycle until the end. In a cycle a
# few blocks are released one after another, and the numbers of steps between them are the same each
# time. The front speed can then be wrong by up to 13 per cent. A cycle of at least
# MIN_UNBIASED_CYCLE_STEPS steps does no harm.
MAX_CYCLE_BLOCKS = 6
MIN_CYCLE_REPEATS = 30
MIN_UNBIASED_CYCLE_STEPS = 50


def combine_laws(laws: Sequence[type[Friction]]):
    """Return a compiled function that computes the friction of any of some laws.

    The arguments of this function are the position of the law in the list, the slip since the
    release, the slip velocity and the two parameters of the law. Kernels cannot choose from a list
    of functions. Each compiled function therefore handles the first law, and calls another one for
    the rest.
    """
    if not laws:
        return kernel_function()(lambda law, slip, velocity, parameter_1, parameter_2: 0.0)
    friction_of_first = register_jitable(laws[0].friction)
    friction_of_others = combine_laws(laws[1:])

    @kernel_function()
    def friction(law, slip, velocity, parameter_1, parameter_2):
        """Return the friction of law number ``law`` in the list: its first or a later one."""
        if law == 0:
            return friction_of_first(slip, velocity, parameter_1, parameter_2)
        return friction_of_others(law - 1, slip, velocity, parameter_1, parameter_2)

    return friction


friction_by_law_number = combine_laws(LAWS)


@kernel_function()
def compute_forces(medium, motion, sliding, history, t, first, last):
    """Compute the forces on blocks first..last-1, and release those that reach the threshold.

    The forces are written into the row ACCELERATION of ``motion.derivatives``. Returns the number
    of sliding blocks.

    sliding : mask of the blocks that slide
    t : time at the start of the step
    """
    slip, velocity = motion.derivatives[SLIP], motion.derivatives[VELOCITY]
    force, tau = motion.derivatives[ACCELERATION], motion.tau
    inverse_dx2, damping = medium.inverse_dx2, medium.damping
    tally = history.tally
    sliding_count, lowest_stress = 0, tally.min_stuck_stress
    for i in range(first, last):
        elastic = inverse_dx2 * (slip[i + 1] - 2.0 * slip[i] + slip[i - 1])
        stress = elastic - medium.leaf_stiffness * slip[i] + tau[i]
        damping_force = damping * (velocity[i + 1] - 2.0 * velocity[i] + velocity[i - 1])
        force[i] = stress + damping_force - medium.alpha * velocity[i]
        if not sliding[i]:
            if not medium.damping_counts_for_release:
                damping_force = 0.0
            lowest_stress = min(lowest_stress, stress + damping_force)
            if stress + damping_force >= 1.0:
                sliding[i] = True
                record_release(history, i, t)
        sliding_count += sliding[i]
    tally.min_stuck_stress = lowest_stress
    return sliding_count


@kernel_function()
def find_sliding_range(sliding, first, last):
    """Return the first sliding block of first..last-1 and the block after the last sliding one.

    At least one of these blocks slides.
    """
    while not sliding[first]:
        first += 1
    while not sliding[last - 1]:
        last -= 1
    return first, last


@kernel_function()
def advance_blocks(medium, motion, sliding, history, dt, end, first, last):
    """Advance the velocities of the sliding blocks of first..last-1, then their slip.

    A block whose velocity would be negative sticks.

    Returns the largest velocity (inf if one is not finite), and the work against friction by a law
    that is not linear (law_number > 0). Linear friction alpha v is already contained in the forces,
    and its work in `viscous_loss`.

    dt : length of the step
    end : time at its end
    """
    slip, velocity = motion.derivatives[SLIP], motion.derivatives[VELOCITY]
    # The force per mass, which is the acceleration.
    force, tally = motion.derivatives[ACCELERATION], history.tally
    fastest = 0.0
    # The sum of friction times mean velocity, which is multiplied by dt and dx at the end.
    friction, work = 0.0, 0.0
    for i in range(first, last):
        if not sliding[i]:
            continue
        before = velocity[i]
        if medium.law_number > 0:
            slip_since_release = slip[i] - motion.slip_at_release[i]
            law_friction = friction_by_law_number(
                medium.law_number,
                slip_since_release,
                before,
                medium.law_parameter_1,
                medium.law_parameter_2,
            )
            # The factor is 0 in the zone without friction, and otherwise 1.
            friction = motion.law_factor[i] * law_friction
            force[i] -= friction
        after = before + dt * force[i]
        # A block that has a mirror image counts twice. Block 1 on the axis has none.
        weight = 2.0 if medium.is_mirrored and i > 1 else 1.0
        if after <= 0.0:
            # A block that stops does no work in this step. Its kinetic energy is a separate loss.
            tally.stick_loss += weight * 0.5 * before * before * medium.dx
            tally.min_velocity = min(tally.min_velocity, after)
            after = 0.0
            sliding[i] = False
            # Until its next release, the block does not slip.
            motion.slip_at_release[i] = slip[i]
            record_stick(history, i, end)
        else:
            work += weight * friction * 0.5 * (before + after)
        velocity[i] = after
        slip[i] += dt * after
        if not after < math.inf:
            return math.inf, 0.0
        fastest = max(fastest, after)
    return fastest, medium.dx * dt * work


@kernel_function()
def viscous_loss(medium, velocity, dt, first, last):
    """Return the energy that damping and friction alpha v dissipate in a step.

    The energy is computed with the velocities at the end of the step. Only blocks first..last-1
    move.
    """
    if medium.beta <= 0.0 and medium.alpha == 0.0:
        return 0.0
    # Sums of (v_{i+1} - v_i)^2 and of v_i^2. On a mirrored lattice they are doubled below, so that
    # block 1 on the axis counts half.
    dv_squared, v_squared = 0.0, 0.0
    # The block before the moving ones counts, too, unless it is a mirror image.
    first_pair = max(first - 1, 1 if medium.is_mirrored else 0)
    for i in range(first_pair, last):
        dv = velocity[i + 1] - velocity[i]
        dv_squared += dv * dv
        weight = 0.5 if medium.is_mirrored and i == 1 else 1.0
        v_squared += weight * velocity[i] * velocity[i]
    power = medium.beta / medium.dx * dv_squared + medium.alpha * medium.dx * v_squared
    sides = 2.0 if medium.is_mirrored else 1.0
    return sides * dt * power


@kernel_function()
def take_samples(recorder, motion, tally, end):
    """Record slip and velocity at all sample times up to ``end`` that are not recorded yet.

    end : time at the end of the step
    """
    times, blocks = recorder.times, recorder.blocks
    slip, velocity = motion.derivatives[SLIP], motion.derivatives[VELOCITY]
    while tally.samples_taken < times.shape[0] and times[tally.samples_taken] <= end:
        n = tally.samples_taken
        # Within a step, slip changes at the constant velocity that belongs to its end.
        time_to_end = end - times[n]
        for p in range(blocks.shape[0]):
            i = blocks[p]
            # Positions outside the lattice have no block.
            if i < 0:
                continue
            recorder.slip[n, p] = slip[i] - time_to_end * velocity[i]
            recorder.velocity[n, p] = velocity[i]
        tally.samples_taken += 1


@kernel_entry
def advance_fixed(medium, motion, sliding, history, recorder, limits):
    """Advance a lattice by the textbook scheme until a limit, and return the reason for stopping.

    The rows of ``motion.derivatives`` are slip, velocity and force. ``sliding`` is a mask of the
    blocks.
    """
    size, tally = motion.tau.shape[0], history.tally
    slip, velocity = motion.derivatives[SLIP], motion.derivatives[VELOCITY]
    # A step visits only the blocks first..last-1: those that moved in the last step, and their
    # neighbours at rest, whose stress has changed. The first step of a call visits all blocks,
    # since the lattice may have been extended.
    first, last = 1, size - 1
    for _ in range(limits.max_steps):
        start = tally.time
        if start >= limits.end_time:
            return END_REACHED
        # A front has come near an end of the lattice if the block EDGE_BLOCKS from the end slides.
        if sliding[size - EDGE_BLOCKS] or (sliding[EDGE_BLOCKS - 1] and not medium.is_mirrored):
            return LATTICE_TOO_SHORT
        dt, end = next_step(limits, start)
        if medium.is_mirrored:
            slip[0], velocity[0] = slip[2], velocity[2]
        sliding_count = compute_forces(medium, motion, sliding, history, start, first, last)
        if sliding_count == 0:
            return ALL_STUCK
        # From here on, only the range of the sliding blocks.
        first, last = find_sliding_range(sliding, first, last)
        fastest, friction_work = advance_blocks(
            medium, motion, sliding, history, dt, end, first, last
        )
        if fastest == math.inf:
            return BLOWN_UP
        tally.friction_loss += friction_work
        if medium.is_mirrored:
            velocity[0] = velocity[2]
        tally.viscous_loss += viscous_loss(medium, velocity, dt, first, last)
        # The range that the next step visits.
        first, last = max(first - 1, 1), min(last + 1, size - 1)
        tally.steps += 1
        tally.block_updates += sliding_count
        tally.time = end
        # The largest force alone would drive a block from rest to the velocity largest_force * end.
        if not fastest <= BLOW_UP_FACTOR * (1.0 + limits.largest_force * end):
            return BLOWN_UP
        take_samples(recorder, motion, tally, end)
    return STEPS_DONE


class FixedStepLattice(Lattice):
    """The state of a scene that the textbook scheme solves."""

    localised = False

    def _advance(self, limits: Limits) -> int:
        """Call the kernel, and return the reason why it stopped."""
        state = (self.medium, self.motion, self.sliding, self.history, self.recorder)
        return advance_fixed(*state, limits)


# Type of lattice of each scheme.
LATTICES = {"localised": Lattice, "fixed_step": FixedStepLattice}


def solve_by_scheme(
    scene: Scene, samples: Samples | None = None, progress: Callable[[float], None] | None = None
) -> Solution:
    """Solve a scene on the lattice by the scheme that it names.

    In the textbook scheme, a front speed can be locked to a fraction of dx/dt, where dt is the
    step. Such a solution is flagged.
    """
    lattice_type = LATTICES[scene.scheme]
    solution = solve_on_lattice(scene, samples, progress, lattice_type=lattice_type)
    if scene.scheme == "fixed_step" and has_locked_front(solution):
        solution.flags = ("locked_front",)
    return solution


def has_locked_front(solution: Solution) -> bool:
    """Return True if the speed of a front is locked to a fraction of dx/dt, where dt is the step.

    In this case the numbers of steps between its releases repeat in a short cycle. Only the
    textbook scheme has such fronts.
    """
    step = solution.numbers["end_time"] / max(solution.numbers["steps"], 1)
    for side in (-1.0, 1.0):
        is_released = (side * solution.x >= 0.0) & np.isfinite(solution.release_time)
        times = np.sort(solution.release_time[is_released])
        steps_between_releases = np.rint(np.diff(times) / step)
        if _ends_in_short_cycle(steps_between_releases):
            return True
    return False


def _ends_in_short_cycle(steps_between_releases: np.ndarray) -> bool:
    """Return True if numbers of steps end in many repeats of a cycle that takes few steps.

    Cycles of many steps are ignored, because they hardly change the front speed.

    steps_between_releases : one number for each two successive releases at a front
    """
    for cycle_blocks in range(1, MAX_CYCLE_BLOCKS + 1):
        needed = MIN_CYCLE_REPEATS * cycle_blocks
        steps = steps_between_releases[-needed:]
        # Each number equals the one that is a cycle earlier.
        repeats = steps.size == needed and (steps[cycle_blocks:] == steps[:-cycle_blocks]).all()
        if repeats and steps[:cycle_blocks].sum() < MIN_UNBIASED_CYCLE_STEPS:
            return True
    return False
