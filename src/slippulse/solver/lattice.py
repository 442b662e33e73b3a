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
# and can be interrupted.
MAX_CALL_STEPS, MAX_CALL_UPDATES = 20_000, 1e7
# Number of blocks on each side at the start. The lattice doubles when a front comes near its end.
INITIAL_BLOCKS = 512
# Each row of an array is a number of whole pages of memory plus an offset (both in blocks). If rows
# began at the same position in their pages, they would compete for the same lines of the cache, and
# cracks would take a quarter to a third longer.
PAGE_BLOCKS, PAGE_OFFSET = 512, 200


class UnstableRun(RuntimeError):
    """Raised if a simulation blows up, meets a value that is not finite, or no longer advances."""


class Lattice:
    """The state of a scene that the localised scheme solves.

    All arrays have one ghost block at each end. medium, motion, history, scratch and recorder are
    groups of `arrays`, and the kernels change the contents of all of them except medium. tally is a
    part of the history. largest_force is the bound of `arrays.Limits`. sampled has the numbers of
    the sampled blocks, where block 0 lies at x = 0.
    """

    localised = True

    def __init__(self, scene: Scene, samples: Samples | None, beta: float) -> None:
        assert self.localised == (scene.scheme == "localised")
        self.scene, self.samples = scene, samples
        self.call_steps = MAX_CALL_STEPS
        self.is_mirrored = scene.symmetric
        self.medium = self._make_medium(beta)
        # Number of the block at array position 0. Block number 0 lies at x = 0.
        self.first_block = 0
        self.motion = arrays.make_motion(scene.order + 2 if self.localised else 3, 0)
        self.tally = arrays.new_record(arrays.TALLY_DTYPE)
        self.history = arrays.History(np.zeros(0), np.zeros(0), self.tally)
        self._prepare_samples(samples or Samples(np.zeros(0), np.zeros(0)))
        # A mirrored lattice has one block at x < 0, the mirror image of the first one at x > 0.
        self._extend(1 if self.is_mirrored else INITIAL_BLOCKS + 1, INITIAL_BLOCKS + 1)
        # The lattice must contain every block that is released at t = 0, also at distant bumps of
        # the pre-stress.
        blocks = int(np.ceil(scene.prestress.nucleation_reach / scene.dx)) + arrays.EDGE_BLOCKS
        if not self.is_mirrored:
            blocks *= 2
        while blocks > self.size - arrays.EDGE_BLOCKS:
            self._double()
        self._release_nucleation()

    def _make_medium(self, beta: float) -> arrays.Medium:
        """Return the constants of the scene for the kernels."""
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
        # Halves are rounded away from zero, so that mirrored positions stay mirrored.
        scaled = samples.positions / self.scene.dx
        number = (np.sign(scaled) * np.floor(np.abs(scaled) + 0.5)).astype(np.int64)
        self.sampled = np.abs(number) if self.is_mirrored else number
        slip, velocity = np.zeros((2, samples.times.size, samples.positions.size))
        self.recorder = arrays.Recorder(samples.times.copy(), number, slip, velocity)

    def _release_nucleation(self) -> None:
        """Release every block whose pre-stress is at the threshold at t = 0."""
        nucleation = np.flatnonzero(self.motion.tau[1:-1] >= 1.0) + 1
        self.history.release_time[nucleation] = 0.0
        for block in nucleation:
            begin_weakening(self.motion, self.medium.law_kink, block)
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

    def _double(self) -> None:
        """Double the lattice on each side that it has."""
        self._extend(0 if self.is_mirrored else self.size, self.size)

    def _extend(self, left: int, right: int) -> None:
        """Add blocks at rest on the left and on the right.

        A few more than ``right`` may be added on the right, see PAGE_OFFSET.
        """
        self.first_block -= left
        old, inside = self.motion, slice(left, left + self.size)
        size = inside.stop + right
        # Use the smallest length whose rows begin at different positions in their pages.
        size += (PAGE_OFFSET - size) % PAGE_BLOCKS
        self.motion = arrays.make_motion(old.w.shape[0], size)
        for values, kept in zip(self.motion, old, strict=True):
            values[..., inside] = kept
        traits = self.scene.friction.traits
        distance = np.abs(np.arange(size) + self.first_block) * self.scene.dx
        self.motion.law_factor[:] = distance >= traits.nucleation_half_length
        # The new blocks are those before and behind the old ones.
        for first, last in ((0, left), (inside.stop, size)):
            x = (np.arange(first, last) + self.first_block) * self.scene.dx
            self.motion.tau[first:last] = self.scene.prestress(x)
        if self.is_mirrored:
            self.motion.tau[0] = self.motion.tau[2]
        # If friction weakens with slip rate without a limit, velocity can grow by this factor.
        weakening = max(-traits.linear_rate, 0.0) * self.scene.duration
        growth = float(np.exp(min(weakening, 600.0)))
        self.largest_force = growth * (float(np.abs(self.motion.tau).max()) + traits.max_drive)
        release_time, stick_time = np.full((2, size), np.nan)
        release_time[inside] = self.history.release_time
        stick_time[inside] = self.history.stick_time
        self.history = arrays.History(release_time, stick_time, self.tally)
        # Array positions have changed by the number of blocks on the left.
        self.tally.first_stuck_block += left
        sampled = self.sampled - self.first_block
        outside = (sampled < 1) | (sampled > size - 2)
        self.recorder = self.recorder._replace(blocks=np.where(outside, -1, sampled))
        self.scratch = arrays.make_scratch(size, self.scene.order)

    def _advance(self, limits: arrays.Limits) -> int:
        """Call the kernel, and return the reason why it stopped."""
        edges = np.flatnonzero(np.diff(self.sliding, prepend=False, append=False))
        segments = arrays.make_segments(self.size)
        segments.edges[: edges.size], segments.count.n = edges, edges.size // 2
        state = (self.medium, self.motion, segments, self.scratch, self.history, self.recorder)
        return taylor.advance(*state, limits)

    def advance_to_end(self, progress: Callable[[float], None] | None) -> int:
        """Advance to the end of the scene, and return the reason why the kernel stopped.

        Raises UnstableRun if the simulation blows up.
        """
        scene, reason = self.scene, ""
        step = scene.max_step * scene.dx
        while True:
            before = float(self.tally.time)
            updated = np.count_nonzero(self.sliding) if self.localised else self.size
            steps = int(min(max(MAX_CALL_UPDATES / max(updated, 1), 10), self.call_steps))
            limits = arrays.Limits(
                order=scene.order,
                largest_step=step,
                end_time=scene.duration,
                largest_force=self.largest_force,
                max_steps=steps,
            )
            status = self._advance(limits)
            if status == arrays.LATTICE_TOO_SHORT:
                self._double()
            elif status == arrays.BLOWN_UP:
                reason = "slip velocity is not finite or larger than the pre-stress can drive"
            elif status != arrays.STEPS_DONE:
                return status
            elif self.tally.time - before < steps * taylor.SIMULTANEITY_TOLERANCE * step:
                reason = "time no longer advances, since blocks stick and are released again and"
                reason += " again at one instant"
            if reason:
                settings = f"dx = {scene.dx:g}, beta = {self.medium.beta:g}"
                raise UnstableRun(
                    f"the run became unstable at t = {self.tally.time:.6g}: {reason}"
                    f" ({settings}, max_step = {scene.max_step:g})"
                )
            if progress is not None:
                progress(float(min(1.0, self.tally.time / scene.duration)))
