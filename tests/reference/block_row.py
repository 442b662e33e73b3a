"""A block solver that shares no code with ours: Runge-Kutta steps of the whole row.

It is written from the equations of the model. A sliding block has the acceleration
D2(u) - gamma u + tau + beta D2(v), and a stuck block has none. A stuck block is released where this
sum reaches 1, and a sliding block sticks where its velocity falls to 0. Each step ends at the first
event, which is located by false position.
"""

from typing import NamedTuple

import numpy as np

# An event is located to this accuracy in stress or velocity.
EVENT_TOLERANCE = 1e-10


class Row(NamedTuple):
    """Pre-stress of all blocks, spacing, damping, stiffness of the leaf springs."""

    tau: np.ndarray
    dx: float
    beta: float
    gamma: float

    def stress(self, slip: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Return the stress on each block; both ends of the row feel no neighbour."""
        stress = self.tau - self.gamma * slip
        damped = slip + self.beta * velocity
        stress[1:-1] += (damped[2:] - 2.0 * damped[1:-1] + damped[:-2]) / self.dx**2
        return stress


class State(NamedTuple):
    slip: np.ndarray
    velocity: np.ndarray
    is_sliding: np.ndarray


class Fates(NamedTuple):
    """Release and stick time of each block, NaN where there is none."""

    release_time: np.ndarray
    stick_time: np.ndarray


def after_step(row: Row, state: State, step: float) -> State:
    """Return the state after a Runge-Kutta step of fourth order, without events."""
    slip, velocity, is_sliding = state
    rates = [(np.zeros_like(slip), np.zeros_like(slip))]
    for fraction in (0.0, 0.5, 0.5, 1.0):
        moved = velocity + fraction * step * rates[-1][1]
        stress = row.stress(slip + fraction * step * rates[-1][0], moved)
        rates.append((moved, np.where(is_sliding, stress, 0.0)))
    slip_rate, acceleration = (
        (first + 2.0 * second + 2.0 * third + fourth) / 6.0
        for first, second, third, fourth in zip(*rates[1:], strict=True)
    )
    return State(slip + step * slip_rate, velocity + step * acceleration, is_sliding)


def beyond_event(row: Row, state: State) -> np.ndarray:
    """Return how far each block is beyond its next event; negative before the event."""
    stress = row.stress(state.slip, state.velocity)
    return np.where(state.is_sliding, -state.velocity, stress - 1.0)


def step_to_event(row: Row, state: State, block: int, longest: float) -> float:
    """Return the step after which the event of one block, passed after ``longest``, occurs."""
    low, high = 0.0, longest
    # A block that was released at the beginning of the step has not yet a velocity.
    before = min(beyond_event(row, after_step(row, state, 1e-6 * longest))[block], -1e-14)
    after = beyond_event(row, after_step(row, state, longest))[block]
    while True:
        step = low + (high - low) * before / (before - after)
        value = beyond_event(row, after_step(row, state, step))[block]
        if abs(value) < EVENT_TOLERANCE or high - low < 1e-13:
            return step
        # The Illinois rule halves the value at the end that stays.
        if value > 0.0:
            high, after, before = step, value, 0.5 * before
        else:
            low, before, after = step, value, 0.5 * after


def first_event(row: Row, state: State, longest: float) -> tuple[float, int | None]:
    """Return a step up to the first event, and the block of that event; None without an event."""
    step, block = longest, None
    while True:
        values = beyond_event(row, after_step(row, state, step))
        if block is not None:
            values[block] = -1.0
        if not np.any(values > EVENT_TOLERANCE):
            return step, block
        block = int(np.argmax(values))
        step = step_to_event(row, state, block, step)


def simulate_row(row: Row, duration: float, longest_step: float) -> Fates:
    """Simulate blocks that are at rest at the beginning."""
    count = row.tau.size
    is_sliding = row.tau >= 1.0 - 1e-12
    state = State(np.zeros(count), np.zeros(count), is_sliding)
    fates = Fates(np.where(is_sliding, 0.0, np.nan), np.full(count, np.nan))
    time = 0.0
    while time < duration - 1e-12 and state.is_sliding.any():
        step, block = first_event(row, state, min(longest_step, duration - time))
        state = after_step(row, state, step)
        time += step
        if block is None:
            continue
        # Blocks in symmetric positions have their events at the same time.
        happens = np.abs(beyond_event(row, state)) <= EVENT_TOLERANCE
        # A block that was released at this time is at rest, too, and accelerates.
        starts = state.is_sliding & (row.stress(state.slip, state.velocity) > 0.0)
        happens &= ~starts
        happens[block] = True
        stops, releases = happens & state.is_sliding, happens & ~state.is_sliding
        state.velocity[stops] = 0.0
        fates.stick_time[stops], fates.stick_time[releases] = time, np.nan
        fates.release_time[releases & np.isnan(fates.release_time)] = time
        state = state._replace(is_sliding=state.is_sliding ^ happens)
    return fates
