"""The lattice of one scene: its memory, its growth, and the calls of the kernels."""

from collections.abc import Callable

import numpy as np

from ..model.samples import Samples
from ..model.scene import Scene
from . import arrays, taylor
from .friction_terms import begin_to_fall, constants_of

# A call of a kernel makes at most this number of steps, and of updates of a block, which take about
# a tenth of a second. Between calls Python tells the progress and can be interrupted.
CALL_STEPS, CALL_WORK = 20_000, 1e7
# The lattice begins with these blocks on each side, and doubles when a front nears its end.
FIRST_BLOCKS = 512
# The length of a row modulo a page of memory, in blocks. Rows that begin at equal positions in
# their pages compete for the same lines of the cache: cracks took a quarter to a third longer.
PAGE, BEYOND_PAGES = 512, 200


class UnstableRun(RuntimeError):
    """A simulation that blew up, met a value that is not finite, or no longer advanced."""


class Lattice:
    """The state of a scene by the localised scheme, in arrays with a ghost block at each end."""

    localised = True

    def __init__(self, scene: Scene, samples: Samples | None, beta: float) -> None:
        assert self.localised == (scene.scheme == "localised")
        self.scene, self.samples = scene, samples
        self.call_steps = CALL_STEPS
        self.mirror = scene.symmetric
        dx, leaf = scene.dx, scene.gamma
        total, friction = scene.release == "total", constants_of(scene.friction, self.localised)
        per_dx2, damping = 1.0 / (dx * dx), beta / (dx * dx)
        self.medium = arrays.Medium(
            dx, 1.0 / dx, per_dx2, leaf, beta, damping, *friction, self.mirror, total
        )
        # The block at array position 0; block 0 lies at x = 0.
        self.first_block = 0
        self.motion = arrays.make_motion(scene.order + 2 if self.localised else 3, 0)
        self.tally = arrays.record(arrays.TALLY)
        self.history = arrays.History(np.zeros(0), np.zeros(0), self.tally)
        given = samples or Samples(np.zeros(0), np.zeros(0))
        recorded = np.zeros((2, given.times.size, given.positions.size))
        # Halves are rounded away from zero, so that mirrored positions stay mirrored.
        scaled = given.positions / scene.dx
        number = (np.sign(scaled) * np.floor(np.abs(scaled) + 0.5)).astype(np.int64)
        self.sampled = np.abs(number) if self.mirror else number
        self.recorder = arrays.Recorder(given.times.copy(), number, *recorded)
        self._extend(1 if self.mirror else FIRST_BLOCKS + 1, FIRST_BLOCKS + 1)
        # All blocks that are released at t = 0 are on it, also at distant bumps and in a table.
        reach = scene.prestress.nucleation_reach
        blocks = (int(np.ceil(reach / scene.dx)) + arrays.ROOM) * (1 if self.mirror else 2)
        while blocks > self.size - arrays.ROOM:
            self._double()
        first = np.flatnonzero(self.motion.tau[1:-1] >= 1.0) + 1
        self.history.release_time[first] = 0.0
        for block in first:
            begin_to_fall(self.motion, self.medium.bend, block)
        self.tally.first_stick_time = np.nan
        self.tally.releases = first.size

    @property
    def size(self) -> int:
        """Length of a row."""
        return self.motion.tau.size

    @property
    def sliding(self) -> np.ndarray:
        """Mask of the blocks that slide."""
        return np.isfinite(self.history.release_time) & np.isnan(self.history.stick_time)

    def _double(self) -> None:
        self._extend(0 if self.mirror else self.size, self.size)

    def _extend(self, left: int, right: int) -> None:
        """Add blocks at rest: these numbers on the left and on the right, or a few more there."""
        self.first_block -= left
        old, inside = self.motion, slice(left, left + self.size)
        size = inside.stop + right
        # The least length with rows at different positions in their pages.
        size += (BEYOND_PAGES - size) % PAGE
        self.motion = arrays.make_motion(old.w.shape[0], size)
        for values, kept in zip(self.motion, old, strict=True):
            values[..., inside] = kept
        traits = self.scene.friction.traits
        away = np.abs(np.arange(size) + self.first_block) * self.scene.dx
        self.motion.resists[:] = away >= traits.nucleation_half_length
        for first, last in ((0, left), (inside.stop, size)):
            x = (np.arange(first, last) + self.first_block) * self.scene.dx
            self.motion.tau[first:last] = self.scene.prestress(x)
        if self.mirror:
            self.motion.tau[0] = self.motion.tau[2]
        # Where friction weakens with slip rate, without a limit, velocity can grow by this factor.
        weakening = max(-traits.linear_rate, 0.0) * self.scene.duration
        growth = float(np.exp(min(weakening, 600.0)))
        self.largest_force = growth * (float(np.abs(self.motion.tau).max()) + traits.max_drive)
        release, stick = np.full((2, size), np.nan)
        release[inside], stick[inside] = self.history.release_time, self.history.stick_time
        self.history = arrays.History(release, stick, self.tally)
        self.tally.first_stuck_block += left
        sampled = self.sampled - self.first_block
        outside = (sampled < 1) | (sampled > size - 2)
        self.recorder = self.recorder._replace(blocks=np.where(outside, -1, sampled))
        self.scratch = arrays.make_scratch(size, self.scene.order)

    def _advance(self, limits: arrays.Limits) -> int:
        """Call the kernel. Returns the reason why it stopped."""
        edges = np.flatnonzero(np.diff(self.sliding, prepend=False, append=False))
        segments = arrays.make_segments(self.size)
        segments.edges[: edges.size], segments.count.n = edges, edges.size // 2
        state = (self.medium, self.motion, segments, self.scratch, self.history, self.recorder)
        return taylor.advance(*state, limits)

    def advance_to_end(self, progress: Callable[[float], None] | None) -> int:
        """Advance to the end of the scene, or raise UnstableRun. Returns why the kernel stopped."""
        scene, reason = self.scene, ""
        step = scene.max_step * scene.dx
        while True:
            before = float(self.tally.time)
            updated = np.count_nonzero(self.sliding) if self.localised else self.size
            steps = int(min(max(CALL_WORK / max(updated, 1), 10), self.call_steps))
            limits = scene.order, step, scene.duration, self.largest_force, steps
            status = self._advance(arrays.Limits(*limits))
            if status == arrays.GROW:
                self._double()
            elif status == arrays.UNSTABLE:
                reason = "slip velocity is not finite or beyond anything the pre-stress can drive"
            elif status != arrays.CONTINUE:
                return status
            elif self.tally.time - before < steps * taylor.SIMULTANEOUS * step:
                reason = "it no longer advances, blocks stick and are released over and over"
                reason += " at one instant"
            if reason:
                settings = f"dx = {scene.dx:g}, beta = {self.medium.beta:g}"
                raise UnstableRun(
                    f"the run became unstable at t = {self.tally.time:.6g}: {reason}"
                    f" ({settings}, max_step = {scene.max_step:g})"
                )
            if progress is not None:
                progress(float(min(1.0, self.tally.time / scene.duration)))
