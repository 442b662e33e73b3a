"""Search for the first zero in time of the slip velocity, for each position by itself.

The velocity is sampled from the release on at equal time steps, and where waves arrive. The first
sample below 0 brackets the stick time. A dip below 0 between two samples would be missed by the
signs alone, so that each lowest of three samples is looked at again, with finer steps:

    du/dt
      |    . .
      |  .     .          .
      | .        .     .     .        the lowest of three samples is looked at again
      |            . .         .
    0 +--------------------------.--- t
      |                            .  the first sample below 0 brackets the stick time
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .vector_roots import roots_between

# The first sample is at least this fraction of a step after the release.
FIRST_SAMPLE = 0.01
# Number of times of each position that are computed together.
BATCH_SIZE = 8
# The largest number of samples of all positions together, which take 3 GB.
MAX_SAMPLES = 2 * 10**8
# The two steps next to a minimum of du/dt are divided into this number of parts, and the two parts
# next to the minimum once more.
FINE_PARTS = 24
# Error of a stick time.
TIME_TOLERANCE = 1e-12
# Fractions of a step, from its end to its start, at which du/dt is computed if it is 0 at the start
# of the step.
BRACKET_FRACTIONS = 0.5 ** np.arange(41)
# Slip velocities on a slow front should be 0, and are below this.
QUIET_VELOCITY = 1e-12


class VelocitySamples(NamedTuple):
    """Slip velocities at positions (rows) and times (columns)."""

    x: np.ndarray
    time: np.ndarray
    velocity: np.ndarray


@dataclass(frozen=True)
class StickSearch:
    """A search at equal time steps, until a final time; velocity(x, time) is du/dt at points.

    Between two arrivals of waves du/dt is analytic, and changes little during a step
    (`part.SEARCH_STEP`).
    """

    velocity: Callable[[np.ndarray, np.ndarray], np.ndarray]
    step: float
    until: float

    def find_stick_times(self, x: np.ndarray, release: np.ndarray, waves: np.ndarray) -> np.ndarray:
        """Return stick times at positions that are released; NaN if a block never sticks.

        waves are the times at which waves arrive, [position, wave].
        """
        times = self._sample_times(release, waves)
        out = np.full(x.shape, np.nan)
        # The last two samples of a batch are kept, since a minimum next to them may lie below 0.
        # At the start they are the release itself, twice. The velocity of -1 is lower than that of
        # the release, which therefore does not count as a minimum.
        last_time = np.stack([release, release], axis=1)
        last_velocity = np.tile([-1.0, 0.0], (x.size, 1))
        sliding = np.flatnonzero(release < self.until)
        while sliding.size:
            batch = self._sample(x[sliding], times[sliding, :BATCH_SIZE])
            times = times[:, BATCH_SIZE:]
            time = np.append(last_time[sliding], batch.time, axis=1)
            velocity = np.append(last_velocity[sliding], batch.velocity, axis=1)
            samples = VelocitySamples(x[sliding], time, velocity)
            is_stuck = batch.velocity <= 0.0
            has_stuck = is_stuck.any(axis=1)
            # Columns of the samples begin with the two that were kept.
            first_stuck = np.where(has_stuck, 2 + np.argmax(is_stuck, axis=1), time.shape[1])
            stick = self._zeros_next_to_minima(samples, first_stuck)
            rows = np.flatnonzero(has_stuck & ~np.isfinite(stick))
            stick[rows] = self._zeros_in_steps(samples, rows, first_stuck[rows])
            out[sliding] = stick
            last_time[sliding], last_velocity[sliding] = time[:, -2:], velocity[:, -2:]
            sliding = sliding[~np.isfinite(stick) & (time[:, -1] < self.until)]
        return out

    def _sample_times(self, release: np.ndarray, waves: np.ndarray) -> np.ndarray:
        """Return the times of the samples, [position, time]: equal steps and arrivals of waves."""
        longest = self.until - np.min(release, initial=self.until)
        count = release.size * (longest / self.step + BATCH_SIZE + waves.shape[1])
        if count > MAX_SAMPLES:
            allowed = f"a time until which sticks are found from {MAX_SAMPLES:.0e} samples"
            raise ValueError(f"duration: {self.until:g} takes {count:.2g}; allowed: {allowed}")
        batch_count = longest // (BATCH_SIZE * self.step) + 1
        steps = self.step * np.arange(1, BATCH_SIZE * batch_count + 1)
        ends = np.full((release.size, BATCH_SIZE), self.until)
        times = np.concatenate([release[:, None] + steps, waves, ends], axis=1)
        # Right after the release du/dt is 0 apart from rounding, so that no sample is taken there.
        # Written with ~, so that a wave that never arrives (NaN) is left out as well.
        is_too_early = ~(times > release[:, None] + FIRST_SAMPLE * self.step)
        times[is_too_early] = self.until
        np.minimum(times, self.until, out=times)
        times.sort(axis=1)
        return times

    def _sample(self, x: np.ndarray, time: np.ndarray) -> VelocitySamples:
        """Return slip velocities at times, [position, time]."""
        velocity = self.velocity(np.repeat(x, time.shape[1]), time.ravel())
        return VelocitySamples(x, time, velocity.reshape(time.shape))

    def _zeros_next_to_minima(self, samples: VelocitySamples, first: np.ndarray) -> np.ndarray:
        """Return the first zero of du/dt in a dip between samples, for each row; NaN if none.

        A sample is a minimum if it is lower than the sample before it, and not higher than the one
        after it. Around each minimum du/dt is sampled again with finer steps. If all fine samples
        are positive, this is repeated around the lowest of them. ``first`` has the column of the
        first sample at or below 0 in each row; later minima are ignored.
        """
        first_zeros = np.full(samples.x.shape, np.nan)
        change = np.diff(samples.velocity, axis=1)
        # Column j of the masks belongs to sample j + 1, the middle one of three.
        is_minimum = (change[:, :-1] < 0.0) & (change[:, 1:] >= 0.0)
        # Samples at the end of a row may repeat the final time.
        is_minimum &= samples.time[:, 2:] > samples.time[:, 1:-1]
        is_before_first = np.arange(1, change.shape[1]) < first[:, None]
        # A row occurs once for each of its minima.
        rows, before = np.nonzero(is_minimum & is_before_first)
        start, end = samples.time[rows, before], samples.time[rows, before + 2]
        for _ in range(2 if rows.size else 0):
            fine = self._sample(samples.x[rows], np.linspace(start, end, FINE_PARTS + 1, axis=1))
            # The first fine sample is positive, so column 0 means that no sample is at or below 0.
            column = np.argmax(fine.velocity <= 0.0, axis=1)
            with_zero = np.flatnonzero(column)
            zeros = self._zeros_in_steps(fine, with_zero, column[with_zero])
            first_zeros[rows[with_zero]] = np.fmin(first_zeros[rows[with_zero]], zeros)
            positive = np.flatnonzero((fine.velocity > 0.0).all(axis=1))
            lowest = np.clip(np.argmin(fine.velocity[positive], axis=1), 1, FINE_PARTS - 1)
            rows = rows[positive]
            start, end = fine.time[positive, lowest - 1], fine.time[positive, lowest + 1]
        return first_zeros

    def _zeros_in_steps(
        self, samples: VelocitySamples, rows: np.ndarray, columns: np.ndarray
    ) -> np.ndarray:
        """Return zeros of du/dt in steps: one for each row, in the step that ends at its column.

        du/dt is not positive at the end of the step. If it never rises above 0 in the step, a time
        next to the start of the step is returned.
        """
        x = samples.x[rows]
        start, end = samples.time[rows, columns - 1], samples.time[rows, columns]
        at_start, at_end = samples.velocity[rows, columns - 1], samples.velocity[rows, columns]
        target = np.zeros(rows.size)
        # If du/dt is 0 at the start of the step, which is the release, the zero is bracketed from a
        # time where it has risen. Next to a point where a slow front stops it does so only briefly.
        quiet = np.flatnonzero(at_start <= 0.0)
        span = (end - start)[quiet, None]
        fine = self._sample(x[quiet], start[quiet, None] + span * BRACKET_FRACTIONS)
        # The columns go from the end of the step, where du/dt has not risen, to its start.
        risen = np.argmax(fine.velocity > QUIET_VELOCITY, axis=1)
        row = np.arange(quiet.size)
        target[quiet] = QUIET_VELOCITY
        start[quiet], end[quiet] = fine.time[row, risen], fine.time[row, risen - 1]
        at_start[quiet] = fine.velocity[row, risen] - QUIET_VELOCITY
        at_end[quiet] = fine.velocity[row, risen - 1] - QUIET_VELOCITY
        zeros, bracketed = end.copy(), np.flatnonzero(at_start > 0.0)

        def above_target(time: np.ndarray, which: np.ndarray) -> np.ndarray:
            """Return du/dt less its target, for some of the rows with a bracket."""
            chosen = bracketed[which]
            return self.velocity(x[chosen], time) - target[chosen]

        zeros[bracketed] = roots_between(
            above_target,
            lower=start[bracketed],
            upper=end[bracketed],
            at_lower=at_start[bracketed],
            at_upper=at_end[bracketed],
            xtol=TIME_TOLERANCE,
        )
        return zeros
