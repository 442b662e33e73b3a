"""Friction in the kernels of the Taylor step: laws that are linear or piecewise linear.

Friction that is linear in slip velocity, alpha v, dissipates energy like damping, and its
dissipation is part of the viscous loss. Piecewise linear friction falls with the slip or slip rate
of a block until it reaches a kink, beyond which friction is constant. Passing the kink, in either
direction, is an event. Kernels are compiled separately for laws with a kink: where ``law_kink`` is
None, the functions below are empty and cost nothing.
"""

from typing import NamedTuple

from ..model.friction import LAWS
from ..model.friction_laws.law import Friction, LawKink
from .arrays import ACCELERATION, SLIP, VELOCITY
from .jit import kernel_function
from .stencils import block_range


class FrictionConstants(NamedTuple):
    """The constants of friction in `Medium`."""

    alpha: float
    law_number: int
    law_parameter_1: float
    law_parameter_2: float
    law_kink: LawKink | None


def friction_constants(friction: Friction, localised: bool) -> FrictionConstants:
    """Return the constants of a law of friction for the kernels of a scheme.

    localised : True for the Taylor step, False for the textbook scheme
    """
    traits = friction.traits
    is_linear = "continuum" in friction.schemes
    if localised or is_linear:
        return FrictionConstants(
            alpha=traits.linear_rate,
            law_number=0,
            law_parameter_1=0.0,
            law_parameter_2=0.0,
            law_kink=traits.law_kink,
        )
    parameter_1, parameter_2 = friction.kernel_parameters
    return FrictionConstants(
        alpha=0.0,
        law_number=LAWS.index(type(friction)),
        law_parameter_1=parameter_1,
        law_parameter_2=parameter_2,
        law_kink=None,
    )


@kernel_function()
def begin_weakening(motion, law_kink, block):
    """Start the weakening of a block that is released, and return its friction."""
    if law_kink is not None:
        if law_kink.rate == 0:
            motion.slip_at_release[block] = motion.w[SLIP, block] + motion.offset[block]
        motion.weakening_slope[block] = motion.law_factor[block] * law_kink.fall
        # The block has not slipped since its release, and its slip rate is 0.
        return law_kink.lowest + motion.weakening_slope[block] * law_kink.end
    return 0.0


@kernel_function(inline=True)
def friction_of_block(motion, law_kink, block, argument):
    """Return the piecewise linear friction of a block at a given argument of its law.

    The argument is the slip or the slip rate (see `LawKink`), and a slip is counted from t = 0. For
    a law of slip rate, ``slip_at_release`` stays 0.
    """
    return law_kink.lowest + motion.weakening_slope[block] * (
        motion.slip_at_release[block] + law_kink.end - argument
    )


@kernel_function()
def friction_at_stick(motion, law_kink, block):
    """Return the friction of a block when it sticks.

    A block sticks at slip rate 0, where every law of slip rate has the kinetic value, 0.
    """
    if law_kink is not None and law_kink.rate == 0:
        # The slip at the start of the step, plus its change since then.
        slip = motion.w[SLIP, block] + motion.offset[block]
        return friction_of_block(motion, law_kink, block, slip)
    return 0.0


@kernel_function()
def switch_weakening(motion, law_kink, block):
    """Stop the weakening of a block that passes the kink, or start it again on the way back."""
    if law_kink is not None:
        # The slope is either 0 or ``fall``, and takes the other value.
        motion.weakening_slope[block] = law_kink.fall - motion.weakening_slope[block]


@kernel_function(inline=True)
def add_weakening(w, k, first, last, column, motion, law_kink):
    """Add the decrease of piecewise linear friction to time derivative k of slip.

    Friction falls by the slope times its argument, the slip or the slip rate (see `LawKink`).
    Derivative k of slip therefore contains the slope times derivative k - 2 of the argument. This
    is row k - 2 of ``w`` if the argument is the slip, and row k - 1 if it is the slip rate.

    w : time derivatives of slip; its column i is block i + ``column`` of the lattice
    """
    if law_kink is not None:
        for i in block_range(first, last):
            w[k, i] += motion.weakening_slope[i + column] * w[k - 2 + law_kink.rate, i]


@kernel_function(inline=True)
def subtract_friction(motion, first, last, law_kink):
    """Subtract piecewise linear friction from the accelerations of blocks first..last-1."""
    if law_kink is not None:
        w = motion.w
        for i in block_range(first, last):
            w[ACCELERATION, i] -= friction_of_block(motion, law_kink, i, w[law_kink.rate, i])


@kernel_function(inline=True)
def friction_power(medium, motion, segments, law_kink):
    """Return the power that piecewise linear friction dissipates, and its time derivative."""
    # Sums over blocks of friction times velocity, and of the time derivative of this product.
    power, power_slope = 0.0, 0.0
    if law_kink is not None:
        w, weakening_slope = motion.w, motion.weakening_slope
        for r in range(segments.count.n):
            for i in block_range(segments.edges[2 * r], segments.edges[2 * r + 1]):
                # A block that has a mirror image counts twice.
                weight = 2.0 if medium.is_mirrored and i > 1 else 1.0
                friction = friction_of_block(motion, law_kink, i, w[law_kink.rate, i])
                power += weight * friction * w[VELOCITY, i]
                # Friction changes at the rate of minus the slope times the argument's derivative.
                power_slope_of_block = (
                    friction * w[ACCELERATION, i]
                    - weakening_slope[i] * w[law_kink.rate + 1, i] * w[VELOCITY, i]
                )
                power_slope += weight * power_slope_of_block
    return medium.dx * power, medium.dx * power_slope


@kernel_function()
def subtract_rate_strengthening(w, k, first, last, alpha):
    """Subtract derivative k - 2 of the friction alpha v from time derivative k of slip."""
    for i in block_range(first, last):
        w[k, i] -= alpha * w[k - 1, i]


@kernel_function(reorder=True)
def sum_velocity_products(w, first, last):
    """Return the sums of v^2 and of v a over blocks first..last-1.

    Here v is the velocity and a the acceleration of a block. The sums give the dissipation by
    friction alpha v, and half of its time derivative.
    """
    square, product = 0.0, 0.0
    for i in block_range(first, last):
        square += w[VELOCITY, i] * w[VELOCITY, i]
        product += w[VELOCITY, i] * w[ACCELERATION, i]
    return square, product
