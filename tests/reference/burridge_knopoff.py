"""A chain of blocks and springs, integrated independently of the lattice code.

Blocks have unit mass, and the springs between them unit stiffness. Between two events (a block is
released, or sticks) the sliding blocks obey one ordinary differential equation. It is solved by an
adaptive Runge-Kutta method of eighth order at a tolerance near rounding. Steps are so short that no
event is missed.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from .lattice_state import second_difference

SOLVER_OPTIONS = {"method": "DOP853", "max_step": 0.0125, "rtol": 1e-12, "atol": 1e-13}
# Events within this time count as one, as on the two sides of a symmetric chain.
SIMULTANEOUS = 1e-9
# A released block has no velocity at first, so only a margin below this negative value is an event.
MARGIN_ROUNDING = 1e-14


@dataclass
class Chain:
    """A chain of blocks at the positions 0, +-1, +-2, ..., which is at rest at first.

    It must be so long that the end blocks never move.
    """

    # The force on each block when nothing has moved.
    initial_force: np.ndarray
    leaf_stiffness: float
    # The damping of the springs between neighbours.
    damping: float
    # "total": the damping force helps to release a block; "elastic": it does not.
    release: str

    def __post_init__(self) -> None:
        """Set all blocks to rest."""
        count = self.initial_force.size
        self.slip, self.slip_velocity = np.zeros(count), np.zeros(count)
        self.release_time, self.stick_time = np.full(count, np.nan), np.full(count, np.nan)
        self.sliding = np.zeros(count, dtype=bool)
        self.releases = self.sticks = 0

    def elastic_force(self, slip: np.ndarray) -> np.ndarray:
        """Return the initial force with that of the springs; the end blocks are held."""
        leaf_force = self.leaf_stiffness * slip
        return second_difference(slip, 1.0) - leaf_force + self.initial_force

    def damping_force(self, velocity: np.ndarray) -> np.ndarray:
        """Return the force of the dampers between neighbours."""
        return self.damping * second_difference(velocity, 1.0)

    def threshold_force(self, slip: np.ndarray, velocity: np.ndarray) -> np.ndarray:
        """Return the force that the release rule compares with 1."""
        force = self.elastic_force(slip)
        return force + self.damping_force(velocity) if self.release == "total" else force

    def rate(self, _time: float, state: np.ndarray) -> np.ndarray:
        """Return the time derivative of slip and velocity, which is 0 for stuck blocks."""
        slip, velocity = np.split(state, 2)
        force = self.elastic_force(slip) + self.damping_force(velocity)
        slip_rate = np.where(self.sliding, velocity, 0.0)
        velocity_rate = np.where(self.sliding, force, 0.0)
        return np.concatenate([slip_rate, velocity_rate])

    def run(self, duration: float) -> "Chain":
        """Advance the chain until a time or until all blocks are stuck, and return it."""

        def next_event(_time: float, state: np.ndarray) -> float:
            """Return a number that falls below 0 at the next event."""
            return self._margins(state).min() + MARGIN_ROUNDING

        next_event.terminal, next_event.direction = True, -1.0
        starts = self.threshold_force(self.slip, self.slip_velocity) >= 1.0
        self._release(starts, 0.0)
        time = 0.0
        while time < duration and self.sliding.any():
            state = np.concatenate([self.slip, self.slip_velocity])
            span = (time, duration)
            path = solve_ivp(self.rate, span, state, events=next_event, **SOLVER_OPTIONS)
            time, last_state = path.t[-1], path.y[:, -1].copy()
            self.slip, self.slip_velocity = np.split(last_state, 2)
            self._apply_events(time)
        return self

    def _margins(self, state: np.ndarray) -> np.ndarray:
        """Return a number for each block that is above 0 until its next event.

        For a sliding block it is the velocity, and for a stuck block the force that is still
        missing for its release.
        """
        slip, velocity = np.split(state, 2)
        missing_force = 1.0 - self.threshold_force(slip, velocity)
        return np.where(self.sliding, velocity, missing_force)

    def _apply_events(self, time: float) -> None:
        """Stick and release the blocks whose event is now."""
        state = np.concatenate([self.slip, self.slip_velocity])
        slip_rate, velocity_rate = np.split(self.rate(time, state), 2)
        force_rate = self.threshold_force(slip_rate, velocity_rate) - self.initial_force
        margins = self._margins(state)
        velocity_vanishes = margins <= SIMULTANEOUS * np.abs(velocity_rate)
        stops = self.sliding & velocity_vanishes & (velocity_rate < 0.0)
        force_suffices = margins <= SIMULTANEOUS * np.abs(force_rate)
        starts = ~self.sliding & force_suffices & (force_rate > 0.0)
        self.sliding[stops] = False
        self.slip_velocity[stops] = 0.0
        self.stick_time[stops] = time
        self.sticks += int(stops.sum())
        self._release(starts, time)

    def _release(self, starts: np.ndarray, time: float) -> None:
        """Let some blocks slide, and record the time of their first release."""
        self.sliding |= starts
        self.release_time[starts & np.isnan(self.release_time)] = time
        self.stick_time[starts] = np.nan
        self.releases += int(starts.sum())
