"""Friction that depends on slip rate: -alpha v in the Taylor step, and its dissipation."""

from .jit import inner
from .stencils import blocks


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
