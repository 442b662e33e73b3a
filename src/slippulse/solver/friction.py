"""Laws of friction in the kernels: linear in slip rate in the Taylor step, any in the textbook one.

In the Taylor step the term is -alpha v, and its dissipation belongs to the viscous loss.
"""

from collections.abc import Sequence

from numba.extending import register_jitable

from ..model.friction import COULOMB, LAWS
from ..model.friction_laws.law import Friction
from .jit import inner
from .stencils import blocks


def constants_of(friction: Friction) -> tuple[float, int, float, float]:
    """The constants alpha, law, first and second of `Medium`."""
    if friction.linear_rate or friction == COULOMB:
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
def resist(medium, motion, sliding):
    """Subtract the friction of sliding blocks from the force in w[2], except alpha v."""
    if medium.law == 0:
        return
    slip, velocity, force = motion.w[0], motion.w[1], motion.w[2]
    for i in range(1, slip.shape[0] - 1):
        if sliding[i]:
            since, v = slip[i] - motion.released[i], velocity[i]
            value = law_of_friction(medium.law, since, v, medium.first, medium.second)
            motion.friction[i] = motion.resists[i] * value
            force[i] -= motion.friction[i]


@inner()
def work_on_friction(medium, motion, dt):
    """Work of a step against the friction at its start, with the velocities at its end."""
    velocity, friction = motion.w[1], motion.friction
    work = 0.0
    for i in range(1, velocity.shape[0] - 1):
        work += friction[i] * velocity[i]
    if medium.mirror:
        work = 2.0 * work - friction[1] * velocity[1]
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
