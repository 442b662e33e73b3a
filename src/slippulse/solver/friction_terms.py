"""Friction in the kernels of the Taylor step: laws that are linear or piecewise linear.

Friction that is linear in slip velocity, alpha v, dissipates energy like damping, and its
dissipation is part of the viscous loss. Piecewise linear friction falls with the slip or slip rate
of a block until it reaches a kink, beyond which friction is constant. Passing the kink, in either
direction, is an event. Kernels are compiled separately for laws with a kink: where ``law_kink`` is
None, the functions below are empty and cost nothing.

The groups of numbers and arrays ``medium``, ``motion`` and ``segments`` are defined in `arrays`.
Row k of ``w``, which is ``motion.derivatives``, is time derivative k of slip; its columns are
blocks.
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
    # The exact solution covers only friction that is 0, or linear in slip velocity.
    is_linear = "continuum" in friction.schemes
    # Both schemes solve linear friction by its constant alpha. The Taylor step also solves
    # piecewise linear friction, by the constants of its kink, and no other laws. The law number 0
    # means that no other law is needed.
    if localised or is_linear:
        return FrictionConstants(
            alpha=traits.linear_rate,
            law_number=0,
            law_parameter_1=0.0,
            law_parameter_2=0.0,
            law_kink=traits.law_kink,
        )
    # The textbook scheme calls the function of any other law.
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
    """Start the weakening of a block that is released, and return its friction.

    The argument of the law is the slip since the release or the slip rate. Row ``argument_row`` of
    the time derivatives of slip is SLIP for the first kind of law, and VELOCITY for the second.

    law_kink : constants of a piecewise linear law; None for other laws, which need no start
    """
    if law_kink is not None:
        # The factor is 1, except in the zone of nucleation, where it is 0. Only slip weakening has
        # such a zone. Its friction beyond the kink is 0, so that with the slope 0 it is 0 always.
        weakening_slope = motion.law_factor[block] * law_kink.weakening_slope
        motion.weakening_slope[block] = weakening_slope
        if law_kink.argument_row == SLIP:
            # The slip at the start of the step, plus the slip by earlier events of the step.
            slip = motion.derivatives[SLIP, block] + motion.event_slip[block]
            motion.slip_at_release[block] = slip
        # The argument of the law is 0 now. From here to the kink, friction falls to its value
        # beyond the kink.
        return law_kink.friction_beyond + weakening_slope * law_kink.argument_at_kink
    return 0.0


@kernel_function(inline=True)
def friction_of_block(motion, law_kink, block, argument):
    """Return the piecewise linear friction of a block. Beyond the kink its slope is 0.

    argument : slip of the block since t = 0, or its slip rate for a law of slip rate, in which
        ``slip_at_release`` is always 0
    """
    argument_at_kink = motion.slip_at_release[block] + law_kink.argument_at_kink
    return law_kink.friction_beyond + motion.weakening_slope[block] * (argument_at_kink - argument)


@kernel_function()
def friction_at_stick(motion, law_kink, block):
    """Return the friction of a block at the instant at which it sticks.

    At slip rate 0, friction is 0 by every law that does not depend on slip.

    block : a block that `hold_block` has stopped, so that ``motion.event_slip`` already contains
        its slip in this step until now
    """
    if law_kink is not None and law_kink.argument_row == SLIP:
        # The slip at the start of the step, plus the slip in the step until the stick.
        slip = motion.derivatives[SLIP, block] + motion.event_slip[block]
        return friction_of_block(motion, law_kink, block, slip)
    return 0.0


@kernel_function()
def switch_weakening(motion, law_kink, block):
    """Stop the weakening of a block that passes the kink, or start it again on the way back."""
    if law_kink is not None:
        # The slope of the block is either 0 or that of the law, and takes the other value. (In the
        # zone of nucleation, where slip weakening has no friction, blocks have no kink.)
        motion.weakening_slope[block] = law_kink.weakening_slope - motion.weakening_slope[block]


@kernel_function(inline=True)
def add_weakening(w, k, first, last, block_of_column_0, motion, law_kink):
    """Add the contribution of piecewise linear friction to time derivative k of slip.

    Friction falls by the slope times its argument, the slip or the slip rate. Friction is a part of
    the acceleration, so that derivative k of slip contains the slope times derivative k - 2 of the
    argument. The latter is derivative k - 2 of slip, or k - 1 if the argument is the slip rate.

    w : time derivatives of slip (rows) of some blocks; column i is block i + block_of_column_0
    """
    if law_kink is not None:
        for i in block_range(first, last):
            derivative_of_argument = w[k - 2 + law_kink.argument_row, i]
            w[k, i] += motion.weakening_slope[i + block_of_column_0] * derivative_of_argument


@kernel_function(inline=True)
def subtract_piecewise_linear_friction(motion, first, last, law_kink):
    """Subtract piecewise linear friction from the accelerations of blocks first..last-1."""
    if law_kink is not None:
        w = motion.derivatives
        for i in block_range(first, last):
            argument = w[law_kink.argument_row, i]
            w[ACCELERATION, i] -= friction_of_block(motion, law_kink, i, argument)


@kernel_function(inline=True)
def friction_power(medium, motion, segments, law_kink):
    """Return the power that piecewise linear friction dissipates, and its time derivative."""
    # Sums over blocks of friction times velocity, and of the time derivative of this product.
    power, power_slope = 0.0, 0.0
    if law_kink is not None:
        w, weakening_slope = motion.derivatives, motion.weakening_slope
        for r in range(segments.count.n):
            for i in block_range(segments.edges[2 * r], segments.edges[2 * r + 1]):
                # A block that has a mirror image counts twice.
                weight = 2.0 if medium.is_mirrored and i > 1 else 1.0
                # The argument of friction is slip or slip rate, and the next row its derivative.
                argument = w[law_kink.argument_row, i]
                argument_rate = w[law_kink.argument_row + 1, i]
                friction = friction_of_block(motion, law_kink, i, argument)
                friction_decrease_rate = weakening_slope[i] * argument_rate
                power += weight * friction * w[VELOCITY, i]
                power_slope += weight * (
                    friction * w[ACCELERATION, i] - friction_decrease_rate * w[VELOCITY, i]
                )
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
