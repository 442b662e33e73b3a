"""Inner loops of the Taylor step: each a plain pass over one contiguous run of sliding blocks.

Arrays come in as slices that start one block before the run, so that every loop starts at 0 and vectorises: an
index that could be negative would have to be tested for wrapping, which costs a factor 4 to 10.
"""

from __future__ import annotations

from .jit import compiled


@compiled()
def first_acceleration(out, strain, velocity, slip, tau, per_dx, leaf, damping):
    """Acceleration of each block: strain difference, leaf spring, pre-stress, damping.

    The elastic force is taken from the strain rather than from second differences of slip, which cancel when slip
    is large (gamma -> 0).
    """
    n = out.shape[0]
    if damping == 0.0 and leaf == 0.0:
        for i in range(n):
            out[i] = per_dx * (strain[i + 1] - strain[i]) + tau[i + 1]
    elif damping == 0.0:
        for i in range(n):
            out[i] = per_dx * (strain[i + 1] - strain[i]) - leaf * slip[i + 1] + tau[i + 1]
    elif leaf == 0.0:
        for i in range(n):
            out[i] = (
                per_dx * (strain[i + 1] - strain[i])
                + tau[i + 1]
                + damping * ((velocity[i + 2] - velocity[i + 1]) - (velocity[i + 1] - velocity[i]))
            )
    else:
        for i in range(n):
            out[i] = (
                per_dx * (strain[i + 1] - strain[i])
                - leaf * slip[i + 1]
                + tau[i + 1]
                + damping * ((velocity[i + 2] - velocity[i + 1]) - (velocity[i + 1] - velocity[i]))
            )


@compiled()
def next_derivative(out, lower, upper, per_dx2, leaf, damping):
    """Time derivative n+2 of slip from derivatives n (``lower``) and n+1 (``upper``)."""
    n = out.shape[0]
    if damping == 0.0 and leaf == 0.0:
        for i in range(n):
            out[i] = per_dx2 * ((lower[i + 2] - lower[i + 1]) - (lower[i + 1] - lower[i]))
    elif damping == 0.0:
        for i in range(n):
            out[i] = (
                per_dx2 * ((lower[i + 2] - lower[i + 1]) - (lower[i + 1] - lower[i])) - leaf * lower[i + 1]
            )
    elif leaf == 0.0:
        for i in range(n):
            out[i] = per_dx2 * ((lower[i + 2] - lower[i + 1]) - (lower[i + 1] - lower[i])) + damping * (
                (upper[i + 2] - upper[i + 1]) - (upper[i + 1] - upper[i])
            )
    else:
        for i in range(n):
            out[i] = (
                per_dx2 * ((lower[i + 2] - lower[i + 1]) - (lower[i + 1] - lower[i]))
                - leaf * lower[i + 1]
                + damping * ((upper[i + 2] - upper[i + 1]) - (upper[i + 1] - upper[i]))
            )


@compiled()
def velocity_after(out, w, first, last, step, order):
    """Velocity of blocks first..last-1 a time ``step`` later, from the derivatives of slip in ``w``."""
    n = last - first
    target = out[first:last]
    if order == 4:
        v, a, b, c, d = (
            w[1, first:last],
            w[2, first:last],
            w[3, first:last],
            w[4, first:last],
            w[5, first:last],
        )
        h2, h3, h4 = step / 2.0, step / 3.0, step / 4.0
        for i in range(n):
            target[i] = v[i] + step * (a[i] + h2 * (b[i] + h3 * (c[i] + h4 * d[i])))
        return
    top = w[order + 1, first:last]
    for i in range(n):
        target[i] = top[i]
    for k in range(order, 0, -1):
        row = w[k, first:last]
        factor = step / k
        for i in range(n):
            target[i] = row[i] + factor * target[i]


@compiled()
def count_stopping(after, velocity, acceleration, step, floor):
    """How many blocks may stop within a step: below ``floor`` at its end, not a number, or slowing down to pass it.

    A velocity that dips below 0 and returns within the step is seen by its tangent at the start.
    """
    n = after.shape[0]
    count = 0
    for i in range(n):
        count += (not (after[i] >= floor)) | (velocity[i] + step * acceleration[i] < floor)
    return count


@compiled()
def advance_slip(w, velocity, first, last, step, order):
    """Advance slip by its Taylor polynomial and take over the new velocity; the slip increment is left in w[2]."""
    n = last - first
    slip, v = w[0, first:last], w[1, first:last]
    increment, new = w[2, first:last], velocity[first:last]
    if order == 4:
        b, c, d = w[3, first:last], w[4, first:last], w[5, first:last]
        h2, h3, h4, h5 = step / 2.0, step / 3.0, step / 4.0, step / 5.0
        for i in range(n):
            du = step * (v[i] + h2 * (increment[i] + h3 * (b[i] + h4 * (c[i] + h5 * d[i]))))
            increment[i] = du
            slip[i] += du
            v[i] = new[i]
        return
    top = w[order + 1, first:last]
    factor = step / (order + 1)
    for i in range(n):
        top[i] *= factor
    for k in range(order, 0, -1):
        row = w[k, first:last]
        factor = step / k
        for i in range(n):
            top[i] = factor * (row[i] + top[i])
    for i in range(n):
        increment[i] = top[i]
        slip[i] += top[i]
        v[i] = new[i]


@compiled()
def advance_strain(strain, increment, per_dx):
    """Strain between neighbours from their slip increments; both slices start one block before the run."""
    n = strain.shape[0]
    for i in range(n):
        strain[i] += per_dx * (increment[i + 1] - increment[i])


@compiled(reorder=True)
def stretching(velocity, acceleration):
    """Sums over neighbours of (dv)^2 and dv da, the viscous dissipation and half its rate in lattice units."""
    n = velocity.shape[0] - 1
    square, product = 0.0, 0.0
    for i in range(n):
        dv = velocity[i + 1] - velocity[i]
        square += dv * dv
        product += dv * (acceleration[i + 1] - acceleration[i])
    return square, product


@compiled()
def polynomial(coefficients, degree, h):
    """Value at h of a polynomial, lowest power first."""
    value = coefficients[degree]
    for k in range(degree - 1, -1, -1):
        value = coefficients[k] + h * value
    return value


@compiled()
def crossing(coefficients, degree, h):
    """Root in (0, h] of a polynomial that changes sign there: bisection made fast by Newton steps.

    The sign at 0 tells the direction: at h it may be lost to rounding, and then the root is h.
    """
    lower, upper = 0.0, h
    rising = coefficients[0] < 0.0
    root = 0.5 * h
    for _ in range(100):
        value = coefficients[degree]
        slope = 0.0
        for k in range(degree - 1, -1, -1):
            slope = value + root * slope
            value = coefficients[k] + root * value
        if (value > 0.0) == rising:
            upper = root
        else:
            lower = root
        change = -value / slope if slope != 0.0 else h
        candidate = root + change
        if not (lower < candidate < upper):
            candidate = 0.5 * (lower + upper)
        if abs(candidate - root) <= 4e-16 * h or upper - lower <= 4e-16 * h:
            return candidate
        root = candidate
    return root
