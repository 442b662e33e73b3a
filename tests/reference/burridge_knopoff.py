"""Blocks and springs of unit mass and stiffness, integrated independently of the lattice code.

Between two events the sliding blocks obey one ordinary differential equation, solved by an adaptive
Runge-Kutta method of eighth order at a tolerance near rounding. Steps are short, so that an event
that comes and goes is seen, too.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from .lattice_state import second_difference

ACCURACY = {"method": "DOP853", "max_step": 0.0125, "rtol": 1e-12, "atol": 1e-13}
# Events this close are one, as on the two sides of a symmetric chain.
TOGETHER, ROUNDING = 1e-9, 1e-14


@dataclass
class Chain:
    """A chain of blocks at 0, +-1, +-2, ..., at rest at first; the end blocks must never move."""

    # The force on each block when nothing has moved.
    pull: np.ndarray
    # The stiffness of each leaf spring, and the damping of the springs between neighbours.
    leaf: float
    damping: float
    # "total": the damping force helps to release a block; "elastic": it does not.
    release: str

    def __post_init__(self) -> None:
        n = self.pull.size
        self.slip, self.slip_velocity = np.zeros(n), np.zeros(n)
        self.release_time, self.stick_time = np.full(n, np.nan), np.full(n, np.nan)
        self.sliding = np.zeros(n, dtype=bool)
        self.releases = self.sticks = 0

    def elastic(self, slip: np.ndarray) -> np.ndarray:
        """Force of the springs and of the pull; the ends are held."""
        return second_difference(slip, 1.0) - self.leaf * slip + self.pull

    def drag(self, velocity: np.ndarray) -> np.ndarray:
        return self.damping * second_difference(velocity, 1.0)

    def threshold_force(self, slip: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        return self.elastic(slip) + (self.drag(velocity) if self.release == "total" else 0.0)

    def rate(self, _time: float, state: np.ndarray) -> np.ndarray:
        """Time derivative of slip and velocity: stuck blocks keep both."""
        slip, velocity = np.split(state, 2)
        acceleration = np.where(self.sliding, self.elastic(slip) + self.drag(velocity), 0.0)
        return np.concatenate([np.where(self.sliding, velocity, 0.0), acceleration])

    def run(self, duration: float) -> "Chain":
        # A block just released has no velocity yet: only what is beyond rounding is an event.
        first = lambda _time, state: self._margins(state).min() + ROUNDING
        first.terminal, first.direction = True, -1.0
        self._release(self.threshold_force(self.slip, self.slip_velocity) >= 1.0, 0.0)
        time = 0.0
        while time < duration and self.sliding.any():
            state = np.concatenate([self.slip, self.slip_velocity])
            path = solve_ivp(self.rate, (time, duration), state, events=first, **ACCURACY)
            time, (self.slip, self.slip_velocity) = path.t[-1], np.split(path.y[:, -1].copy(), 2)
            self._apply(time)
        return self

    def _margins(self, state: np.ndarray) -> np.ndarray:
        """Distance of each block to its release, or its velocity: above 0 until an event."""
        slip, velocity = np.split(state, 2)
        return np.where(self.sliding, velocity, 1.0 - self.threshold_force(slip, velocity))

    def _apply(self, time: float) -> None:
        state = np.concatenate([self.slip, self.slip_velocity])
        slip_rate, velocity_rate = np.split(self.rate(time, state), 2)
        force_rate = self.threshold_force(slip_rate, velocity_rate) - self.pull
        margin = self._margins(state)
        stops = self.sliding & (margin <= TOGETHER * np.abs(velocity_rate)) & (velocity_rate < 0.0)
        starts = ~self.sliding & (margin <= TOGETHER * np.abs(force_rate)) & (force_rate > 0.0)
        self.sliding[stops] = False
        self.slip_velocity[stops] = 0.0
        self.stick_time[stops] = time
        self.sticks += int(stops.sum())
        self._release(starts, time)

    def _release(self, starts: np.ndarray, time: float) -> None:
        self.sliding |= starts
        self.release_time[starts & np.isnan(self.release_time)] = time
        self.stick_time[starts] = np.nan
        self.releases += int(starts.sum())
