"""Search for the first zero in time of the slip velocity, for each position by itself.

The velocity is sampled from the release on, at equal time steps and when waves arrive. The stick
time lies between the first sample that is not positive and the sample before it. Between two
positive samples the velocity may fall below 0 and rise again. To find such a dip, the velocity is
sampled again with finer steps around each minimum, a sample that is lower than its neighbours:

    du/dt
      |    . .
      |  .     .          .
      | .        .     .     .        a minimum: sampled again with finer steps
      |            . .         .
    0 +--------------------------.--- t
      |                            .  the first sample below 0: the stick is just before it
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from .vector_roots import roots_between

# The first sample is at least this fraction of a step after the release.
FIRST_SAMPLE = 0.01
# Number of samples of each position that are computed together.
BATCH_SIZE = 8
# The largest number of samples of all positions together, which take 3 GB.
MAX_SAMPLES = 2 * 10**8
# The two steps next to a minimum of du/dt are divided into this number of parts. Then the two parts
# next to the minimum of the finer samples are divided in the same way.
FINE_PARTS = 24
# Error of a stick time.
TIME_TOLERANCE = 1e-12
# If du/dt is 0 at the start of a step, it is computed at these fractions of the step, from its end
# to its start.
STEP_FRACTIONS = 0.5 ** np.arange(41)
# Slip velocity on a slow front is 0, with errors below this.
QUIET_VELOCITY = 1e-12


class VelocitySamples(NamedTuple):
    """Slip velocities at positions (rows) and times (columns)."""

    x: np.ndarray
    time: np.ndarray
    velocity: np.ndarray


@dataclass(frozen=True)
class StickSearch:
    """A search for stick times at equal time steps, up to the final time ``until``.

    velocity(x, time) returns du/dt at points. Between two arrivals of waves du/dt is smooth, and
    the step is so short that du/dt changes little during it. A block sticks when du/dt falls below
    0, by more than ``rounding_error``.
    """

    velocity: Callable[[np.ndarray, np.ndarray], np.ndarray]
    step: float
    until: float
    rounding_error: float = 0.0

    def find_stick_times(
        self, x: np.ndarray, release: np.ndarray, wave_arrivals: np.ndarray
    ) -> np.ndarray:
        """Return the stick times of positions x, which are released at the times ``release``.

        NaN if a block does not stick before the final time. wave_arrivals has the times at which
        waves arrive, with a row for each position and a column for each wave.
        """
        times = self._sample_times(release, wave_arrivals)
        stick_times = np.full(x.shape, np.nan)
        # The samples are computed in batches, one after another in time. A batch is examined
        # together with the two samples before it, because a minimum is found from three samples.
        # Before the first batch, both are the release itself. The first of them has the velocity
        # -1, so that the release does not count as a minimum.
        kept_times = np.stack([release, release], axis=1)
        kept_velocities = np.tile([-1.0, 0.0], (x.size, 1))
        # Numbers of the positions whose blocks have not stuck until the last sample.
        sliding = np.flatnonzero(release < self.until)
        while sliding.size:
            batch = self._sample(x[sliding], times[sliding, :BATCH_SIZE])
            times = times[:, BATCH_SIZE:]
            time = np.append(kept_times[sliding], batch.time, axis=1)
            velocity = np.append(kept_velocities[sliding], batch.velocity, axis=1)
            samples = VelocitySamples(x[sliding], time, velocity)
            # The column of the first sample that shows a stick, or the number of columns if none
            # does. The two kept samples, in columns 0 and 1, are not searched.
            is_stuck = batch.velocity <= -self.rounding_error
            has_stuck = is_stuck.any(axis=1)
            stuck_column = np.where(has_stuck, 2 + np.argmax(is_stuck, axis=1), time.shape[1])
            # A zero in a dip between earlier samples comes first. Otherwise the zero is in the step
            # that ends at the first sample that shows a stick.
            zeros = self._zeros_next_to_minima(samples, stuck_column)
            rows = np.flatnonzero(has_stuck & ~np.isfinite(zeros))
            zeros[rows] = self._zeros_in_steps(samples, rows, stuck_column[rows])
            stick_times[sliding] = zeros
            kept_times[sliding], kept_velocities[sliding] = time[:, -2:], velocity[:, -2:]
            sliding = sliding[~np.isfinite(zeros) & (time[:, -1] < self.until)]
        return stick_times

    def _sample_times(self, release: np.ndarray, wave_arrivals: np.ndarray) -> np.ndarray:
        """Return the times of the samples, [position, time]: equal steps and arrivals of waves.

        release has the time of the release of each position. wave_arrivals has the times at which
        waves arrive, with a row for each position, NaN for a wave that never arrives. The times of
        a position are sorted. Each row ends with the final time, which it repeats if fewer samples
        are needed than in other rows. `find_stick_times` takes BATCH_SIZE columns at a time, and
        the remaining columns as the last batch.
        """
        longest = self.until - np.min(release, initial=self.until)
        sample_count = release.size * (longest / self.step + BATCH_SIZE + wave_arrivals.shape[1])
        if sample_count > MAX_SAMPLES:
            raise ValueError(
                f"duration: {self.until:g}; to find the stick times, the slip velocity must be"
                f" evaluated at {sample_count:.2g} points; allowed: a shorter duration, with at"
                f" most {MAX_SAMPLES:.0e} points"
            )
        batch_count = longest // (BATCH_SIZE * self.step) + 1
        steps = self.step * np.arange(1, BATCH_SIZE * batch_count + 1)
        final_times = np.full((release.size, BATCH_SIZE), self.until)
        times = np.concatenate([release[:, None] + steps, wave_arrivals, final_times], axis=1)
        # Right after the release du/dt is 0 apart from rounding, so that no sample is taken there.
        # A wave that never arrives (NaN) is left out as well, because NaN is not late enough. The
        # final time takes the place of these samples, and of those after it.
        is_late_enough = times > release[:, None] + FIRST_SAMPLE * self.step
        times[~is_late_enough] = self.until
        np.minimum(times, self.until, out=times)
        times.sort(axis=1)
        return times

    def _sample(self, x: np.ndarray, time: np.ndarray) -> VelocitySamples:
        """Return the slip velocities of positions at times, which are indexed [position, time]."""
        velocity = self.velocity(np.repeat(x, time.shape[1]), time.ravel())
        return VelocitySamples(x, time, velocity.reshape(time.shape))

    def _zeros_next_to_minima(
        self, samples: VelocitySamples, stuck_column: np.ndarray
    ) -> np.ndarray:
        """Return the first zero of du/dt in a dip between samples, for each row; NaN if none.

        A sample is a minimum if it is lower than the sample before it, and not higher than the one
        after it. Around each minimum du/dt is sampled again with finer steps. If all fine samples
        are positive, this is repeated around the lowest of them. stuck_column has the column of the
        first sample that shows a stick in each row; later minima are ignored.
        """
        first_zeros = np.full(samples.x.shape, np.nan)
        change = np.diff(samples.velocity, axis=1)
        # Column j of the masks belongs to sample j + 1, the middle one of three.
        is_minimum = (change[:, :-1] < 0.0) & (change[:, 1:] >= 0.0)
        # Samples at the end of a row may repeat the final time.
        is_minimum &= samples.time[:, 2:] > samples.time[:, 1:-1]
        is_before_stick = np.arange(1, change.shape[1]) < stuck_column[:, None]
        # A row may have several minima. From here on, arrays have one element for each minimum:
        # its row, and the times of the samples before and after it.
        row, column_before = np.nonzero(is_minimum & is_before_stick)
        start, end = samples.time[row, column_before], samples.time[row, column_before + 2]
        if not row.size:
            return first_zeros
        for _ in range(2):
            fine = self._sample(samples.x[row], np.linspace(start, end, FINE_PARTS + 1, axis=1))
            # The column of the first fine sample that shows a stick. Column 0 means that none does,
            # since the first fine sample is positive.
            first_below = np.argmax(fine.velocity <= -self.rounding_error, axis=1)
            with_zero = np.flatnonzero(first_below)
            zeros = self._zeros_in_steps(fine, with_zero, first_below[with_zero])
            first_zeros[row[with_zero]] = np.fmin(first_zeros[row[with_zero]], zeros)
            # The other minima are examined once more, between the neighbours of the lowest sample.
            positive = np.flatnonzero((fine.velocity > 0.0).all(axis=1))
            lowest = np.clip(np.argmin(fine.velocity[positive], axis=1), 1, FINE_PARTS - 1)
            row = row[positive]
            start, end = fine.time[positive, lowest - 1], fine.time[positive, lowest + 1]
        return first_zeros

    def _zeros_in_steps(
        self, samples: VelocitySamples, rows: np.ndarray, end_columns: np.ndarray
    ) -> np.ndarray:
        """Return the zero of du/dt in one time step of each of the given rows of samples.

        The step ends at the sample in the end column, where du/dt is not positive, and starts at
        the sample before. If du/dt never rises above 0 in the step, a time next to the start is
        returned.
        """
        x = samples.x[rows]
        start, end = samples.time[rows, end_columns - 1], samples.time[rows, end_columns]
        at_start = samples.velocity[rows, end_columns - 1]
        at_end = samples.velocity[rows, end_columns]
        # The search is for the time at which du/dt falls to this value.
        target = np.zeros(rows.size)
        # At the start of a step that begins at the release, du/dt is 0, but the block does not
        # stick there. Such a step is shortened to the part in which du/dt falls to its rounding
        # error, QUIET_VELOCITY, and this is its target.
        quiet = np.flatnonzero(at_start <= 0.0)
        shortened = self._shorten_steps(x[quiet], start[quiet], end[quiet])
        target[quiet] = QUIET_VELOCITY
        start[quiet], end[quiet] = shortened.time.T
        at_start[quiet], at_end[quiet] = shortened.velocity.T - QUIET_VELOCITY
        # If du/dt never rises above 0, the shortened step starts and ends at a time next to the
        # start of the step. This time is then returned.
        zeros, has_zero = end.copy(), np.flatnonzero(at_start > 0.0)

        def above_target(time: np.ndarray, which: np.ndarray) -> np.ndarray:
            """Return du/dt minus its target, for some of the steps with a zero."""
            chosen = has_zero[which]
            return self.velocity(x[chosen], time) - target[chosen]

        zeros[has_zero] = roots_between(
            above_target,
            lower=start[has_zero],
            upper=end[has_zero],
            at_lower=at_start[has_zero],
            at_upper=at_end[has_zero],
            xtol=TIME_TOLERANCE,
        )
        return zeros

    def _shorten_steps(self, x: np.ndarray, start: np.ndarray, end: np.ndarray) -> VelocitySamples:
        """Return samples at both ends of shorter steps, in which du/dt falls to QUIET_VELOCITY.

        In the given steps du/dt is 0 at the start, and not positive at the end. In between it may
        rise, but next to a point where a slow front stops it does so only briefly. So it is sampled
        at times that become ever denser towards the start. If it does not rise, both samples are
        the one next to the start.
        """
        duration = end - start
        fine = self._sample(x, start[:, None] + duration[:, None] * STEP_FRACTIONS)
        # The columns go back in time: column 0 is the end of the step, and the last column is next
        # to its start. The shorter step starts at the latest sample above QUIET_VELOCITY, and ends
        # at the sample after that, in the column before.
        is_above = fine.velocity > QUIET_VELOCITY
        rises, latest_above = is_above.any(axis=1), np.argmax(is_above, axis=1)
        last_column = STEP_FRACTIONS.size - 1
        start_column = np.where(rises, latest_above, last_column)
        end_column = np.where(rises, latest_above - 1, last_column)
        columns = np.stack([start_column, end_column], axis=1)
        rows = np.arange(x.size)[:, None]
        return VelocitySamples(x, fine.time[rows, columns], fine.velocity[rows, columns])
