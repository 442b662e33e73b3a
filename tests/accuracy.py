"""Every tolerance of the tests, once, with its reason."""

# Front speed without damping: the issue of a whole pipeline at the step of preset "paper"; an exact formula.
FRONT_SPEED = 1e-3
# Slip left by a steady pulse without damping; an exact formula.
SLIP = 1e-3
# The damped theory against its independently computed table, which has 7 digits.
TABLE_DIGITS = 1e-6
# Damped simulations at dx = 0.02 with leaf springs, whose correction of order gamma dx^2/tau_0^2 the theory leaves out.
DAMPED_SPEED = 1e-3
# Read off the published figure by pixel: a slope and a time, an intercept (absolute), a curved edge.
READ_SLOPE, READ_INTERCEPT, READ_EDGE = 1e-2, 0.05, 1.5e-2
# Blocks and springs integrated by another method to 1e-11: what is left is the step of the scheme under test.
REFERENCE = 2e-5
# Sums in another order.
ROUNDING = 1e-11
# Energy that the balance may miss at the step of preset "paper" (the scheme is of fourth order, the loss of third).
ENERGY = 1e-4
# Extrapolation of T_trans and L_trans from three spacings to the exact theory.
TRANSITION = 5e-4
# Share times and peak under a stress boundary at dx = 0.01.
SHARE_TIME, STRESS_PEAK = 5e-3, 2e-3
# Observed orders may differ from the formal one by this much where the next order is not negligible.
ORDER_BAND = 0.35
