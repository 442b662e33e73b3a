"""Laws of friction in the kernels: piecewise linear in the Taylor step, any in the textbook one.

In the Taylor step, the dissipation by a term -alpha v belongs to the viscous loss. Linear slip
weakening is linear until the slip of a block since its release is d_c, which is an event. Kernels
are compiled anew for it: where ``d_c`` is None, the functions of weakening are empty.
"""

from collections.abc import Sequence

from numba.extending import register_jitable

from ..model.friction import LAWS
from ..model.friction_laws.law import Friction
from .jit import inner
from .stencils import blocks


def constants_of(
    friction: Friction, localised: bool
) -> tuple[float, int, float, float, float | None]:
    """The constants alpha, law, first, second and d_c of `Medium`."""
    if localised or "continuum" in friction.schemes:
        return friction.traits.linear_rate, 0, 0.0, 0.0, friction.traits.linear_weakening
    return 0.0, LAWS.index(type(friction)), *friction.constants, None


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
def begin_weakening(motion, d_c, block):
    """Let the friction of a block that is released fall from 1. Returns its friction."""
    if d_c is not None:
        motion.released[block] = motion.w[0, block] + motion.offset[block]
        motion.falls[block] = motion.resists[block] / d_c
        return motion.resists[block]
    return 0.0


@inner()
def end_weakening(medium, d_c, motion, block, weak, tally):
    """Count the work against the friction of a block, which is weak now or sticks before."""
    if d_c is not None:
        weight = 2.0 if medium.mirror and block > 1 else 1.0
        since = motion.w[0, block] + motion.offset[block] - motion.released[block]
        since = d_c if weak else since
        work = motion.falls[block] * since * (d_c - 0.5 * since)
        tally.friction_loss += weight * medium.dx * work
        motion.falls[block] = 0.0


@inner(inline=True)
def weaken(w, k, first, last, column, motion, d_c):
    """Add to time derivative k of slip what friction loses with slip; columns may be shifted."""
    if d_c is not None:
        for i in blocks(first, last):
            w[k, i] += motion.falls[i + column] * w[k - 2, i]


@inner(inline=True)
def resist_weakening(motion, first, last, d_c):
    """Subtract the friction that is left from the accelerations of blocks."""
    if d_c is not None:
        w = motion.w
        for i in blocks(first, last):
            w[2, i] -= motion.falls[i] * (motion.released[i] + d_c - w[0, i])


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
