"""The lattice of one scene: its memory, its growth, and the calls of the kernels.

A `Lattice` holds the arrays that the kernels change. It calls the kernel again and again until the
scene ends, and adds blocks whenever a front comes near the end of the arrays.
"""

from collections.abc import Callable

import numpy as np

from ..model.samples import Samples
from ..model.scene import Scene
from . import arrays, taylor
from .friction_terms import begin_weakening, friction_constants

# Limits of one call of a kernel: the number of steps, and the number of updates of single blocks.
# That many updates take about a tenth of a second. Between two calls, Python reports the progress
# and can be interrupted. A call makes some steps, even if their updates exceed the limit.
MAX_CALL_STEPS, MAX_CALL_UPDATES = 20_000, 1e7
MIN_CALL_STEPS = 10
# Number of blocks on each side at the start. The lattice doubles when a front comes near its end.
INITIAL_BLOCKS = 512
# Each row of an array is a number of whole pages of memory plus an offset (both in blocks). If rows
# began at the same position in their pages, they would compete for the same lines of the cache, and
# cracks would take a quarter to a third longer.
PAGE_BLOCKS, PAGE_OFFSET = 512, 200
# Upper bound on the exponent of the growth of slip velocity. A larger one would overflow.
MAX_GROWTH_EXPONENT = 600.0


class UnstableRun(RuntimeError):
    """Raised if a simulation blows up, meets a value that is not finite, or no longer advances."""


class Lattice:
    """The state of a scene that the localised scheme solves.

    All arrays have one ghost block at each end. Array position p holds the block of number
    p + first_block, and the block of number 0 lies at x = 0.

    - medium, motion, history, scratch and recorder are groups of the module `arrays`. The kernels
      change the contents of all of them except medium.
    - tally is the part of the history with the totals of the run.
    - largest_force is the bound of `arrays.Limits`.
    - sampled_numbers has the numbers of the sampled blocks.
    """

    localised = True

    def __init__(self, scene: Scene, samples: Samples | None, beta: float) -> None:
        assert self.localised == (scene.scheme == "localised")
        self.scene, self.samples = scene, samples
        # A caller can lower this number, to look at the lattice after fewer steps.
        self.max_call_steps = MAX_CALL_STEPS
        self.is_mirrored = scene.symmetric
        # The damping ``beta`` is that of the scene, or its negative.
        self.medium = self._make_medium(beta)
        self.first_block = 0
        # A Taylor step of order n needs slip and its time derivatives 1 to n + 1. The other schemes
        # need slip, velocity and force.
        derivatives = scene.order + 2 if self.localised else 3
        self.motion = arrays.make_motion(derivatives, 0)
        self.tally = arrays.new_record(arrays.TALLY_DTYPE)
        self.history = arrays.History(np.zeros(0), np.zeros(0), self.tally)
        self._prepare_samples(samples or Samples(np.zeros(0), np.zeros(0)))
        # A mirrored lattice has one block at x < 0, the mirror image of the first one at x > 0.
        blocks_on_left = 1 if self.is_mirrored else INITIAL_BLOCKS + 1
        self._extend(blocks_on_left, INITIAL_BLOCKS + 1)
        self._cover_nucleation()
        self._release_nucleation()

    def _make_medium(self, beta: float) -> arrays.Medium:
        """Return the constants of the scene for the kernels; ``beta`` may have another sign."""
        scene, dx = self.scene, self.scene.dx
        return arrays.Medium(
            dx=dx,
            inverse_dx=1.0 / dx,
            inverse_dx2=1.0 / (dx * dx),
            leaf_stiffness=scene.gamma,
            beta=beta,
            damping=beta / (dx * dx),
            is_mirrored=self.is_mirrored,
            damping_counts_for_release=scene.release == "total",
            **friction_constants(scene.friction, self.localised)._asdict(),
        )

    def _prepare_samples(self, samples: Samples) -> None:
        """Find the blocks at the sampled positions, and make the arrays of the samples."""
        # The nearest block. Halves are rounded away from zero, so that mirrored positions stay
        # mirrored.
        in_spacings = samples.positions / self.scene.dx
        numbers = (np.sign(in_spacings) * np.floor(np.abs(in_spacings) + 0.5)).astype(np.int64)
        self.sampled_numbers = np.abs(numbers) if self.is_mirrored else numbers
        slip, velocity = np.zeros((2, samples.times.size, samples.positions.size))
        # `_extend` enters the sampled blocks, by their positions in its arrays.
        no_blocks = np.full_like(numbers, -1)
        self.recorder = arrays.Recorder(samples.times.copy(), no_blocks, slip, velocity)

    def _cover_nucleation(self) -> None:
        """Extend the lattice over all blocks that can be released at t = 0.

        Some of them may lie at distant bumps of the pre-stress.
        """
        blocks_of_reach = int(np.ceil(self.scene.prestress.nucleation_reach / self.scene.dx))
        # The kernel needs EDGE_BLOCKS blocks beyond them on each side, and the last line adds some
        # more for safety.
        blocks_per_side = blocks_of_reach + arrays.EDGE_BLOCKS
        blocks_needed = blocks_per_side if self.is_mirrored else 2 * blocks_per_side
        while blocks_needed > self.size - arrays.EDGE_BLOCKS:
            self._double_length()

    def _release_nucleation(self) -> None:
        """Release every block whose pre-stress is at the threshold at t = 0.

        From then on such a block slides, because it has a release time and no stick time.
        """
        # Array positions of these blocks. The ghost blocks at the two ends are left out.
        nucleation = np.flatnonzero(self.motion.tau[1:-1] >= 1.0) + 1
        self.history.release_time[nucleation] = 0.0
        for block in nucleation:
            begin_weakening(self.motion, self.medium.law_kink, block)
        # No block has stuck yet.
        self.tally.first_stick_time = np.nan
        self.tally.releases = nucleation.size

    @property
    def size(self) -> int:
        """Number of blocks, with the ghost blocks."""
        return self.motion.tau.size

    @property
    def sliding(self) -> np.ndarray:
        """Mask of the blocks that slide."""
        return np.isfinite(self.history.release_time) & np.isnan(self.history.stick_time)

    def _double_length(self) -> None:
        """Double the number of blocks; a mirrored lattice grows only on the right."""
        self._extend(0 if self.is_mirrored else self.size, self.size)

    def _extend(self, left: int, right: int) -> None:
        """Add ``left`` blocks at rest on the left, and ``right`` or some more on the right.

        All arrays are replaced by longer ones.
        """
        # The old blocks have these positions in the new arrays.
        old_blocks = slice(left, left + self.size)
        size = old_blocks.stop + right
        # Add blocks until rows of this length begin at different positions in the pages of memory,
        # which is faster (see PAGE_BLOCKS).
        size += (PAGE_OFFSET - size) % PAGE_BLOCKS
        self.first_block -= left
        self._extend_motion(old_blocks, size)
        self._set_largest_force()
        release_time, stick_time = np.full((2, size), np.nan)
        release_time[old_blocks] = self.history.release_time
        stick_time[old_blocks] = self.history.stick_time
        self.history = arrays.History(release_time, stick_time, self.tally)
        # Array positions have changed by the number of blocks on the left.
        self.tally.first_stuck_block += left
        sampled_blocks = self.sampled_numbers - self.first_block
        is_outside = (sampled_blocks < 1) | (sampled_blocks > size - 2)
        self.recorder = self.recorder._replace(blocks=np.where(is_outside, -1, sampled_blocks))
        self.scratch = arrays.make_scratch(size, self.scene.order)

    def _extend_motion(self, old_blocks: slice, size: int) -> None:
        """Move the state of all blocks into arrays of another size, and add blocks at rest.

        old_blocks : array positions of the present blocks in the new arrays
        """
        old_motion = self.motion
        derivative_count = old_motion.derivatives.shape[0]
        self.motion = arrays.make_motion(derivative_count, size)
        for new_array, old_array in zip(self.motion, old_motion, strict=True):
            new_array[..., old_blocks] = old_array
        distance = np.abs(np.arange(size) + self.first_block) * self.scene.dx
        nucleation_half_length = self.scene.friction.traits.nucleation_half_length
        # The friction of a block is multiplied by a factor. This factor is 0 in the region around
        # x = 0 where a rupture may be nucleated without friction, and 1 elsewhere.
        self.motion.law_factor[:] = distance >= nucleation_half_length
        # The new blocks are those before and behind the old ones.
        for first, last in ((0, old_blocks.start), (old_blocks.stop, size)):
            x = (np.arange(first, last) + self.first_block) * self.scene.dx
            self.motion.tau[first:last] = self.scene.prestress(x)
        if self.is_mirrored:
            # Block 1 lies at x = 0. The ghost block before it is the mirror image of block 2.
            self.motion.tau[0] = self.motion.tau[2]

    def _set_largest_force(self) -> None:
        """Set the bound on the force that drives a block, from its pre-stress and friction."""
        traits = self.scene.friction.traits
        # If friction is alpha v with a negative alpha (the linear rate), velocity grows
        # exponentially, during the run by up to this factor.
        exponent = max(-traits.linear_rate, 0.0) * self.scene.duration
        growth = float(np.exp(min(exponent, MAX_GROWTH_EXPONENT)))
        # Friction that drives slip adds up to ``max_drive`` to the pre-stress.
        largest_prestress = float(np.abs(self.motion.tau).max())
        self.largest_force = growth * (largest_prestress + traits.max_drive)

    def _advance(self, limits: arrays.Limits) -> int:
        """Advance the lattice in one call of the kernel, and return the reason why it stopped.

        limits : size of the steps, and the conditions that end the call
        """
        # The first block of each segment of sliding blocks, and the block after its last one.
        edges = np.flatnonzero(np.diff(self.sliding, prepend=False, append=False))
        segments = arrays.make_segments(self.size)
        segments.edges[: edges.size] = edges
        segments.count.n = edges.size // 2
        state = (self.medium, self.motion, segments, self.scratch, self.history, self.recorder)
        return taylor.advance(*state, limits)

    def advance_to_end(self, progress: Callable[[float], None] | None) -> int:
        """Advance to the end of the scene, and return the reason why the kernel stopped.

        Raises UnstableRun if the simulation blows up.

        progress : function that is called now and then with the fraction of the duration done
        """
        while True:
            start = float(self.tally.time)
            limits = self._limits_of_call()
            status = self._advance(limits)
            if status in (arrays.END_REACHED, arrays.ALL_STUCK):
                return status
            if status == arrays.LATTICE_TOO_SHORT:
                self._double_length()
            else:
                self._check_stability(status, self.tally.time - start, limits)
            if progress is not None:
                progress(float(min(1.0, self.tally.time / self.scene.duration)))

    def _limits_of_call(self) -> arrays.Limits:
        """Return the limits of the next call of the kernel.

        A call makes a limited number of updates of single blocks, so that Python can report the
        progress between two calls.
        """
        scene = self.scene
        # The localised scheme updates only the blocks that slide.
        updates_per_step = np.count_nonzero(self.sliding) if self.localised else self.size
        steps = max(MAX_CALL_UPDATES / max(updates_per_step, 1), MIN_CALL_STEPS)
        return arrays.Limits(
            order=scene.order,
            largest_step=scene.max_step * scene.dx,
            end_time=scene.duration,
            largest_force=self.largest_force,
            max_steps=int(min(steps, self.max_call_steps)),
        )

    def _check_stability(self, status: int, time_advanced: float, limits: arrays.Limits) -> None:
        """Raise UnstableRun if a call of the kernel shows that the simulation blows up.

        status : reason why the kernel stopped: BLOWN_UP or STEPS_DONE
        time_advanced : simulated time of the call
        """
        # Steps that end early are shorter than the others. If they are this short on average, the
        # same blocks have events again and again at one instant.
        shortest_step = taylor.SIMULTANEITY_TOLERANCE * limits.largest_step
        if status == arrays.BLOWN_UP:
            reason = "slip velocity is not finite, or is larger than the pre-stress can drive"
        elif time_advanced < limits.max_steps * shortest_step:
            reason = (
                "time no longer advances, since blocks stick and are released again and again at"
                " one instant"
            )
        else:
            return
        settings = f"dx = {self.scene.dx:g}, beta = {self.medium.beta:g}"
        raise UnstableRun(
            f"the run became unstable at t = {self.tally.time:.6g}: {reason}"
            f" ({settings}, max_step = {self.scene.max_step:g})"
        )
