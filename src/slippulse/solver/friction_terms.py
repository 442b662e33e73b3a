"""Friction in the kernels of the Taylor step, which is piecewise linear.

The dissipation by a term -alpha v belongs to the viscous loss. Friction with a bend falls with the
slip or slip rate of a block until that is at the bend, which is an event, as is the way back.
Kernels are compiled anew for it: where ``bend`` is None, its functions are empty.
"""

from ..model.friction import LAWS
from ..model.friction_laws.law import Friction, LawKink
from .jit import inner
from .stencils import blocks


def constants_of(
    friction: Friction, localised: bool
) -> tuple[float, int, float, float, LawKink | None]:
    """The constants alpha, law, first, second and bend of `Medium`."""
    if localised or "continuum" in friction.schemes:
        return friction.traits.linear_rate, 0, 0.0, 0.0, friction.traits.law_kink
    return 0.0, LAWS.index(type(friction)), *friction.kernel_parameters, None


@inner()
def begin_to_fall(motion, bend, block):
    """Let the friction of a block that is released fall. Returns its friction."""
    if bend is not None:
        if bend.rate == 0:
            motion.released[block] = motion.w[0, block] + motion.offset[block]
        motion.falls[block] = motion.resists[block] * bend.fall
        return bend.lowest + motion.falls[block] * bend.end
    return 0.0


@inner(inline=True)
def resistance(motion, bend, block, reached):
    """Friction of a block with a bend, at its slip or slip rate."""
    return bend.lowest + motion.falls[block] * (motion.released[block] + bend.end - reached)


@inner()
def resistance_at_rest(motion, bend, block):
    """Friction of a block that sticks; laws of slip rate have none."""
    if bend is not None and bend.rate == 0:
        return resistance(motion, bend, block, motion.w[0, block] + motion.offset[block])
    return 0.0


@inner()
def turn(motion, bend, block):
    """Let the friction of a block at the bend cease to fall, or fall again."""
    if bend is not None:
        motion.falls[block] = bend.fall - motion.falls[block]


@inner(inline=True)
def fall(w, k, first, last, column, motion, bend):
    """Add to time derivative k of slip what friction loses; columns may be shifted."""
    if bend is not None:
        for i in blocks(first, last):
            w[k, i] += motion.falls[i + column] * w[k - 2 + bend.rate, i]


@inner(inline=True)
def resist(motion, first, last, bend):
    """Subtract friction with a bend from the accelerations of blocks."""
    if bend is not None:
        w = motion.w
        for i in blocks(first, last):
            w[2, i] -= resistance(motion, bend, i, w[bend.rate, i])


@inner(inline=True)
def power(medium, motion, segments, bend):
    """Work against friction with a bend in unit time, and its time derivative."""
    total, change = 0.0, 0.0
    if bend is not None:
        w, falls = motion.w, motion.falls
        for r in range(segments.count.n):
            for i in blocks(segments.edges[2 * r], segments.edges[2 * r + 1]):
                weight = 2.0 if medium.mirror and i > 1 else 1.0
                friction = resistance(motion, bend, i, w[bend.rate, i])
                total += weight * friction * w[1, i]
                growth = friction * w[2, i] - falls[i] * w[bend.rate + 1, i] * w[1, i]
                change += weight * growth
    return medium.dx * total, medium.dx * change


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
