"""A search for the first zero in time of the slip velocity, for each position by itself."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .vector_roots import roots_between

# The first sample comes this fraction of a step after the release.
LEAST = 0.01
# Number of times that are computed together.
BATCH = 8
# The most times of samples, of all positions together: they take 3 GB.
MOST_TIMES = 2 * 10**8
# Two steps in time next to a minimum of du/dt are cut into this number of parts, twice.
FINE = 24
# Error of a root in time.
TIME = 1e-12
# Fractions of a bracket at which du/dt is looked at, the latest first.
HALVES = 0.5 ** np.arange(41)
# Slip velocities on a slow front are below this, and would be 0.
QUIET = 1e-12


class VelocitySamples(NamedTuple):
    """Slip velocities at positions and times: one row a position, one column a time."""

    x: np.ndarray
    time: np.ndarray
    velocity: np.ndarray


@dataclass(frozen=True)
class StickSearch:
    """A search at steps in time, until an end; velocity(x, time) is du/dt at points.

    Between the waves that come du/dt is analytic, and a step turns the kernel by 0.2
    (`part.SEARCH`): a dip between samples shows in the lowest of three, and is searched again.
    """

    velocity: Callable[[np.ndarray, np.ndarray], np.ndarray]
    step: float
    until: float

    def stick_time(self, x: np.ndarray, release: np.ndarray, waves: np.ndarray) -> np.ndarray:
        """Stick times at released positions, NaN for none; waves come there: [position, wave]."""
        times = self._times(release, waves)
        out = np.full(x.shape, np.nan)
        # The last two samples are kept, since a minimum next to them may lie below 0. The first
        # sample, a velocity of -1, is made up.
        last_time = np.stack([release, release], axis=1)
        last_velocity = np.tile([-1.0, 0.0], (x.size, 1))
        sliding = np.flatnonzero(release < self.until)
        while sliding.size:
            batch = self._sampled(x[sliding], times[sliding, :BATCH])
            times = times[:, BATCH:]
            time = np.append(last_time[sliding], batch.time, axis=1)
            velocity = np.append(last_velocity[sliding], batch.velocity, axis=1)
            samples, below = VelocitySamples(x[sliding], time, velocity), batch.velocity <= 0.0
            stuck = below.any(axis=1)
            first = np.where(stuck, 2 + np.argmax(below, axis=1), time.shape[1])
            stick = self._zeros_next_to_minima(samples, first)
            rows = np.flatnonzero(stuck & ~np.isfinite(stick))
            stick[rows] = self._zeros(samples, rows, first[rows])
            out[sliding] = stick
            last_time[sliding], last_velocity[sliding] = time[:, -2:], velocity[:, -2:]
            sliding = sliding[~np.isfinite(stick) & (time[:, -1] < self.until)]
        return out

    def _times(self, release: np.ndarray, waves: np.ndarray) -> np.ndarray:
        """Times of the samples of each position: equal steps, and where waves come."""
        longest = self.until - np.min(release, initial=self.until)
        count = release.size * (longest / self.step + BATCH + waves.shape[1])
        if count > MOST_TIMES:
            allowed = f"a time until which sticks are found from {MOST_TIMES:.0e} samples"
            raise ValueError(f"duration: {self.until:g} takes {count:.2g}; allowed: {allowed}")
        steps = self.step * np.arange(1, BATCH * (longest // (BATCH * self.step) + 1) + 1)
        ends = np.full((release.size, BATCH), self.until)
        times = np.concatenate([release[:, None] + steps, waves, ends], axis=1)
        # Right after the release du/dt is 0 to rounding.
        times[~(times > release[:, None] + LEAST * self.step)] = self.until
        np.minimum(times, self.until, out=times)
        times.sort(axis=1)
        return times

    def _sampled(self, x: np.ndarray, time: np.ndarray) -> VelocitySamples:
        velocity = self.velocity(np.repeat(x, time.shape[1]), time.ravel())
        return VelocitySamples(x, time, velocity.reshape(time.shape))

    def _zeros_next_to_minima(self, samples: VelocitySamples, first: np.ndarray) -> np.ndarray:
        """Zeros between samples next to minima above 0, before a first column below 0; or NaN."""
        out = np.full(samples.x.shape, np.nan)
        change = np.diff(samples.velocity, axis=1)
        lowest = (change[:, :-1] < 0.0) & (change[:, 1:] >= 0.0)
        lowest &= samples.time[:, 2:] > samples.time[:, 1:-1]
        rows, before = np.nonzero(lowest & (np.arange(1, change.shape[1]) < first[:, None]))
        low, high = samples.time[rows, before], samples.time[rows, before + 2]
        for _ in range(2 if rows.size else 0):
            fine = self._sampled(samples.x[rows], np.linspace(low, high, FINE + 1, axis=1))
            below = np.argmax(fine.velocity <= 0.0, axis=1)
            hits = np.flatnonzero(below)
            zeros = self._zeros(fine, hits, below[hits])
            out[rows[hits]] = np.fmin(out[rows[hits]], zeros)
            rest = np.flatnonzero((fine.velocity > 0.0).all(axis=1))
            middle = np.clip(np.argmin(fine.velocity[rest], axis=1), 1, FINE - 1)
            rows = rows[rest]
            low, high = fine.time[rest, middle - 1], fine.time[rest, middle + 1]
        return out

    def _zeros(self, samples: VelocitySamples, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
        """Zeros of du/dt in steps that end at some columns; about the start if it never rises."""
        x, ends = samples.x[rows], (rows, np.array([columns - 1, columns]))
        time, velocity = samples.time[ends], samples.velocity[ends]
        # A velocity that starts at 0, at release, is followed from where it has risen: next to the
        # point where a slow front stops it does so for a short while only.
        flat = np.flatnonzero(velocity[0] <= 0.0)
        start, end = time[:, flat, None]
        fine = self._sampled(x[flat], start + (end - start) * HALVES)
        # The first column, the end of the step, has not risen.
        risen = np.argmax(fine.velocity > QUIET, axis=1)
        ends = np.arange(flat.size), np.array([risen, risen - 1])
        target = np.zeros(rows.size)
        target[flat] = QUIET
        time[:, flat], velocity[:, flat] = fine.time[ends], fine.velocity[ends] - QUIET
        out, rises = time[1].copy(), np.flatnonzero(velocity[0] > 0.0)

        def above_target(time: np.ndarray, which: np.ndarray) -> np.ndarray:
            return self.velocity(x[rises[which]], time) - target[rises[which]]

        (start, end), (at_start, at_end) = time[:, rises], velocity[:, rises]
        out[rises] = roots_between(above_target, start, end, at_start, at_end, TIME)
        return out
