"""Laws of friction in the kernels: linear in slip rate in the Taylor step, any in the textbook one.

In the Taylor step the term is -alpha v, and its dissipation belongs to the viscous loss.
"""

from collections.abc import Sequence

from numba.extending import register_jitable

from ..model.friction import LAWS
from ..model.friction_laws.law import Friction
from .jit import inner
from .stencils import blocks


def constants_of(friction: Friction) -> tuple[float, int, float, float]:
    """The constants alpha, law, first and second of `Medium`."""
    if "localised" in friction.schemes:
        return float(friction.linear_rate), 0, 0.0, 0.0
    first, second = friction.constants
    return 0.0, LAWS.index(type(friction)), float(first), float(second)


def choose(laws: Sequence[type[Friction]]):
    """Compiled function of the number of a law among ``laws`` and of what the law depends on."""
    first, rest = register_jitable(laws[0].friction), choose(laws[1:]) if laws[1:] else None
    if rest is None:
        return inner()(lambda law, slip, velocity, one, two: first(slip, velocity, one, two))

    @inner()
    def chosen(law, slip, velocity, one, two):
        if law == 0:
            return first(slip, velocity, one, two)
        return rest(law - 1, slip, velocity, one, two)

    return chosen


law_of_friction = choose(LAWS)


@inner()
def resist(medium, motion, sliding, dt):
    """Subtract the friction of sliding blocks, except alpha v, from the force in w[2].

    Returns the work of the step against it, with the mean of the velocities before and after. A
    block that stops in the step works against nothing: its kinetic energy is a loss of its own.
    """
    if medium.law == 0:
        return 0.0
    slip, velocity = motion.w[0], motion.w[1]
    force, work = motion.w[2], 0.0
    for i in range(1, slip.shape[0] - 1):
        if not sliding[i]:
            continue
        since, before = slip[i] - motion.released[i], velocity[i]
        value = law_of_friction(medium.law, since, before, medium.first, medium.second)
        friction = motion.resists[i] * value
        force[i] -= friction
        after = before + dt * force[i]
        if after > 0.0:
            weight = 2.0 if medium.mirror and i > 1 else 1.0
            work += weight * friction * 0.5 * (before + after)
    return medium.dx * dt * work


@inner()
def strengthen(w, k, first, last, alpha):
    """Subtract from time derivative k of slip the growth of friction with slip rate."""
    for i in blocks(first, last):
        w[k, i] -= alpha * w[k - 1, i]


@inner(reorder=True)
def sums_of_motion(w, first, last):
    """Sums of v^2 and v a over blocks: dissipation by rate strengthening, and half its slope."""
    square, product = 0.0, 0.0
    for i in blocks(first, last):
        square += w[1, i] * w[1, i]
        product += w[1, i] * w[2, i]
    return square, product


@inner()
def dissipation_by_rate(medium, w, segments):
    """Dissipation D = alpha dx sum of v_i^2 over all segments, and dD/dt."""
    square, product = 0.0, 0.0
    for r in range(segments.count.n):
        s, p = sums_of_motion(w, segments.starts[r], segments.ends[r])
        # The block at x = 0 has no mirror image.
        once = 0.5 if medium.mirror and segments.starts[r] == 1 else 0.0
        square += s - once * w[1, 1] * w[1, 1]
        product += p - once * w[1, 1] * w[2, 1]
    scale = (2.0 if medium.mirror else 1.0) * medium.alpha * medium.dx
    return scale * square, 2.0 * scale * product
