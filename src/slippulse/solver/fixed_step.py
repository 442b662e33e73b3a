"""The textbook scheme, for comparison: symplectic Euler, with events checked once a step.

It is of first order in the step, and its front speed locks to dx / (n dt) with an integer n.
"""

import math
from collections.abc import Callable, Sequence

import numpy as np
from numba.extending import register_jitable

from ..model.friction import LAWS
from ..model.friction_laws.law import Friction
from ..model.samples import Samples
from ..model.scene import Scene
from .arrays import ALL_STUCK, CONTINUE, DONE, GROW, ROOM, UNSTABLE, Limits
from .jit import entry, inner
from .lattice import Lattice
from .solution import Solution, solve_on_lattice
from .taylor import BLOW_UP, note_release, note_stick

# A front of the textbook scheme that repeats a cycle of so few blocks this often, up to its end, in
# equally many steps, runs at a fraction of dx/dt. In cycles of fewer steps than this, that speed
# errs by up to 13 per cent.
LONGEST_CYCLE, REPEATS, FEW_STEPS = 6, 30, 50


def choose(laws: Sequence[type[Friction]]):
    """Compiled function of the number of a law among ``laws`` and of what the law depends on."""
    if not laws:
        return inner()(lambda law, slip, velocity, one, two: 0.0)
    first, rest = register_jitable(laws[0].friction), choose(laws[1:])

    @inner()
    def chosen(law, slip, velocity, one, two):
        if law == 0:
            return first(slip, velocity, one, two)
        return rest(law - 1, slip, velocity, one, two)

    return chosen


law_of_friction = choose(LAWS)


@inner()
def forces(medium, motion, sliding, history, t):
    """Force on each block, in w[2], and releases at the threshold. Returns how many slide."""
    slip, velocity = motion.w[0], motion.w[1]
    force, tau = motion.w[2], motion.tau
    per_dx2, damping = medium.per_dx2, medium.damping
    tally = history.tally
    moving, lowest = 0, tally.min_stuck_stress
    for i in range(1, tau.shape[0] - 1):
        elastic = per_dx2 * (slip[i + 1] - 2.0 * slip[i] + slip[i - 1])
        stress = elastic - medium.leaf * slip[i] + tau[i]
        drag = damping * (velocity[i + 1] - 2.0 * velocity[i] + velocity[i - 1])
        force[i] = stress + drag - medium.alpha * velocity[i]
        if not sliding[i]:
            if not medium.total:
                drag = 0.0
            lowest = min(lowest, stress + drag)
            if stress + drag >= 1.0:
                sliding[i] = True
                note_release(history, i, t)
        moving += sliding[i]
    tally.min_stuck_stress = lowest
    return moving


@inner()
def move(medium, motion, sliding, history, dt, end):
    """Advance velocity, then slip, never backwards.

    Returns: the largest velocity, or inf; the work against friction, except alpha v.
    """
    slip, velocity = motion.w[0], motion.w[1]
    force, tally = motion.w[2], history.tally
    fastest = 0.0
    friction, work = 0.0, 0.0
    for i in range(1, slip.shape[0] - 1):
        if not sliding[i]:
            continue
        before = velocity[i]
        if medium.law > 0:
            since = slip[i] - motion.released[i]
            value = law_of_friction(medium.law, since, before, medium.first, medium.second)
            friction = motion.resists[i] * value
            force[i] -= friction
        after = before + dt * force[i]
        weight = 2.0 if medium.mirror and i > 1 else 1.0
        if after <= 0.0:
            # A block that stops works against nothing: its kinetic energy is a loss of its own.
            tally.stick_loss += weight * 0.5 * before * before * medium.dx
            tally.min_velocity = min(tally.min_velocity, after)
            after = 0.0
            sliding[i] = False
            motion.released[i] = slip[i]
            note_stick(history, i, end)
        else:
            work += weight * friction * 0.5 * (before + after)
        velocity[i] = after
        slip[i] += dt * after
        if not after < math.inf:
            return math.inf, 0.0
        fastest = max(fastest, after)
    return fastest, medium.dx * dt * work


@inner()
def viscous_loss(medium, velocity, dt):
    """Viscous loss of a step and that to rate strengthening, from the velocities at its end."""
    square, motion = 0.0, 0.0
    for i in range(1 if medium.mirror else 0, velocity.shape[0] - 1):
        dv = velocity[i + 1] - velocity[i]
        square += dv * dv
        motion += (0.5 if medium.mirror and i == 1 else 1.0) * velocity[i] * velocity[i]
    loss = medium.beta / medium.dx * square + medium.alpha * medium.dx * motion
    return (2.0 if medium.mirror else 1.0) * dt * loss


@inner()
def take_samples(recorder, motion, tally, end):
    """Take the samples that are due by ``end``, with the velocity at that time."""
    times, blocks = recorder.times, recorder.blocks
    while tally.samples_taken < times.shape[0] and times[tally.samples_taken] <= end:
        n = tally.samples_taken
        since = end - times[n]
        for p in range(blocks.shape[0]):
            i = blocks[p]
            if i >= 0:
                recorder.slip[n, p] = motion.w[0, i] - since * motion.w[1, i]
                recorder.velocity[n, p] = motion.w[1, i]
        tally.samples_taken += 1


@entry
def advance_fixed(medium, motion, sliding, history, recorder, limits):
    """Advance until a limit; w has slip, velocity, force. Returns the reason why it stopped."""
    size, tally = motion.tau.shape[0], history.tally
    slip, velocity = motion.w[0], motion.w[1]
    for _ in range(limits.steps):
        t = tally.time
        if t >= limits.end_time:
            return DONE
        if sliding[size - ROOM] or (sliding[ROOM - 1] and not medium.mirror):
            return GROW
        dt = min(limits.largest_step, limits.end_time - t)
        end = limits.end_time if dt == limits.end_time - t else t + dt
        if medium.mirror:
            slip[0], velocity[0] = slip[2], velocity[2]
        moving = forces(medium, motion, sliding, history, t)
        if moving == 0:
            return ALL_STUCK
        fastest, work = move(medium, motion, sliding, history, dt, end)
        if fastest == math.inf:
            return UNSTABLE
        tally.friction_loss += work
        if medium.mirror:
            velocity[0] = velocity[2]
        if medium.beta > 0.0 or medium.alpha != 0.0:
            tally.viscous_loss += viscous_loss(medium, velocity, dt)
        tally.steps += 1
        tally.block_updates += moving
        tally.time = end
        if not fastest <= BLOW_UP * (1.0 + limits.largest_force * end):
            return UNSTABLE
        take_samples(recorder, motion, tally, end)
    return CONTINUE


class FixedStepLattice(Lattice):
    """The state of a scene that is solved by this scheme."""

    localised = False

    def _advance(self, limits: Limits) -> int:
        state = (self.medium, self.motion, self.sliding, self.history, self.recorder)
        return advance_fixed(*state, limits)


# The lattice of each scheme.
LATTICES = {"localised": Lattice, "fixed_step": FixedStepLattice}


def solve_by_scheme(
    scene: Scene, samples: Samples | None = None, progress: Callable[[float], None] | None = None
) -> Solution:
    """Solve a scene on the lattice by its scheme."""
    solution = solve_on_lattice(scene, samples, progress, kind=LATTICES[scene.scheme])
    if scene.scheme == "fixed_step" and locked_front(solution):
        solution.flags = ("locked_front",)
    return solution


def locked_front(solution: Solution) -> bool:
    """True if a front of the textbook scheme is locked to a fraction of dx/dt."""
    step = solution.numbers["end_time"] / max(solution.numbers["steps"], 1)
    for side in (-1.0, 1.0):
        released = (side * solution.x >= 0.0) & np.isfinite(solution.release_time)
        times = np.sort(solution.release_time[released])
        counts = np.rint(np.diff(times) / step)
        for cycle in range(1, LONGEST_CYCLE + 1):
            last = counts[-REPEATS * cycle :]
            repeats = last.size == REPEATS * cycle and (last[cycle:] == last[:-cycle]).all()
            if repeats and last[:cycle].sum() < FEW_STEPS:
                return True
    return False
