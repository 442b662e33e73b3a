"""Runs one scene on the lattice: allocation, growth, samples, energy. Arrays in, arrays out."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from ..model.samples import Samples
from ..model.scene import Scene
from . import fixed_step, taylor

# Steps between two returns to Python, for progress and interruption, at most; and sliding blocks times steps, about a
# tenth of a second.
CALL_STEPS, CALL_WORK = 20_000, 1e7
# Blocks on each side at first; the lattice doubles whenever a front comes near its end.
FIRST_BLOCKS = 512
# Length of a row modulo a page of memory, in blocks. Rows that begin at one place of their pages compete for the same
# lines of the cache: a pulse of 200 blocks took 7 to 30 % longer at order 8.
PAGE, BEYOND_PAGES = 512, 200
# Blocks at rest that are kept beyond the outermost released one.
MARGIN = 16


class UnstableRun(RuntimeError):
    """A run blew up or met a value that is not finite."""


@dataclass
class LatticeRun:
    """What a run leaves behind; arrays over the whole lattice, left to right, the mirrored half restored."""

    x: np.ndarray
    prestress: np.ndarray
    release_time: np.ndarray
    stick_time: np.ndarray
    slip: np.ndarray
    slip_velocity: np.ndarray
    slip_acceleration: np.ndarray
    sample_slip: np.ndarray | None
    sample_velocity: np.ndarray | None
    numbers: dict = field(default_factory=dict)


def _row_length(size: int) -> int:
    """The next length from ``size`` on at which rows begin at different places of their pages."""
    return size + (BEYOND_PAGES - size) % PAGE


class Lattice:
    """State of one run, in arrays with one ghost block at each end."""

    def __init__(self, scene: Scene, samples: Samples | None, beta: float) -> None:
        self.scene = scene
        self.beta = beta
        self.leaf = scene.gamma if scene.boundary == "displacement" else 0.0
        self.mirror = scene.symmetric
        self.localised = scene.scheme == "localised"
        self.first_block = -1 if self.mirror else -FIRST_BLOCKS - 1
        size = _row_length(FIRST_BLOCKS + 2 if self.mirror else 2 * FIRST_BLOCKS + 3)
        rows = scene.order + 2 if self.localised else 3
        self.w = np.zeros((rows, size))
        self.strain = np.zeros(size)
        self.release_time = np.full(size, np.nan)
        self.stick_time = np.full(size, np.nan)
        self.counts = np.zeros(9, dtype=np.int64)
        self.totals = np.zeros(7)
        self.totals[taylor.FIRST_STICK] = np.nan
        self.scratch = taylor.scratch(scene.order)
        self.samples = samples
        n_times, n_positions = (samples.times.size, samples.positions.size) if samples else (0, 0)
        self.sample_times = samples.times if samples else np.zeros(0)
        self.sample_slip = np.zeros((n_times, n_positions))
        self.sample_velocity = np.zeros((n_times, n_positions))
        self._fit()
        # Blocks outside the first lattice are looked at too, for a second nucleation point far away.
        while np.any(self._reach_of_release() > size - taylor.ROOM):
            self._grow()
            size = self.w.shape[1]
        self._release_at_start()

    def _reach_of_release(self) -> np.ndarray:
        """Array positions that the bumps need, so that all that is released at t = 0 lies on the lattice."""
        reach = [abs(c) + 4.0 * w for c, _, w in self.scene.prestress.bumps] or [0.0]
        blocks = np.ceil(np.array(reach) / self.scene.dx).astype(np.int64)
        return blocks + taylor.ROOM if self.mirror else 2 * (blocks + taylor.ROOM)

    def _fit(self) -> None:
        """Scratch arrays and the pre-stress for the present size."""
        size = self.w.shape[1]
        self.tau = self.scene.prestress((np.arange(size) + self.first_block) * self.scene.dx)
        if self.mirror:
            self.tau[0] = self.tau[2]
        self.velocity = np.zeros(size)
        self.offset = np.zeros(size)
        self.moved_starts = np.zeros(size, dtype=np.int64)
        self.moved_ends = np.zeros(size, dtype=np.int64)
        self.release_at = np.full(size, np.inf)
        self.stopping_block = np.zeros(size, dtype=np.int64)
        self.stopping_time = np.zeros(size)
        self.largest_force = float(np.max(np.abs(self.tau)))
        blocks = np.full(0, -1, dtype=np.int64)
        if self.samples:
            # Half away from zero, so that mirrored positions stay mirrored.
            scaled = self.samples.positions / self.scene.dx
            number = (np.sign(scaled) * np.floor(np.abs(scaled) + 0.5)).astype(np.int64)
            blocks = (np.abs(number) if self.mirror else number) - self.first_block
            blocks = np.where((blocks < 1) | (blocks > size - 2), -1, blocks)
        self.sample_blocks = blocks

    def _release_at_start(self) -> None:
        size = self.w.shape[1]
        inside = np.arange(size)
        start = (self.tau >= 1.0) & (inside >= 1) & (inside <= size - 2)
        self.release_time[start] = 0.0
        edges = np.flatnonzero(np.diff(np.concatenate([[False], start, [False]]).astype(np.int8)))
        self.starts = np.zeros(size, dtype=np.int64)
        self.ends = np.zeros(size, dtype=np.int64)
        n = edges.size // 2
        self.starts[:n], self.ends[:n] = edges[0::2], edges[1::2]
        self.counts[taylor.RUNS] = n
        self.counts[taylor.RELEASES] = int(start.sum())
        self.sliding = start.copy()

    def _grow(self) -> None:
        """Double the lattice or a little more, on both sides unless it is a mirrored half."""
        size = self.w.shape[1]
        left = 0 if self.mirror else size
        right = _row_length(left + 2 * size) - left - size
        pad = (left, right)
        self.w = np.pad(self.w, ((0, 0), pad))
        self.strain = np.pad(self.strain, pad)
        self.release_time = np.pad(self.release_time, pad, constant_values=np.nan)
        self.stick_time = np.pad(self.stick_time, pad, constant_values=np.nan)
        self.first_block -= left
        if hasattr(self, "starts"):
            n = self.counts[taylor.RUNS]
            self.starts, self.ends = (np.pad(a, (0, left + right)) for a in (self.starts, self.ends))
            self.starts[:n] += left
            self.ends[:n] += left
            self.sliding = np.pad(self.sliding, pad)
            self.counts[taylor.FIRST_STUCK] += left
        self._fit()

    def _advance(self) -> int:
        scene = self.scene
        shared = (self.release_time, self.stick_time, self.counts, self.totals)
        recorded = (self.sample_times, self.sample_blocks, self.sample_slip, self.sample_velocity)
        rules = (self.mirror, scene.release == "total", scene.dx, self.leaf, self.beta)
        step = scene.max_step * scene.dx
        if self.localised:
            return taylor.advance(
                self.w, self.offset, self.strain, self.velocity, self.tau, self.starts, self.ends, self.moved_starts,
                self.moved_ends, self.release_at, self.stopping_block, self.stopping_time, *self.scratch, *shared,
                *recorded, *rules, scene.order, step, scene.duration, self.largest_force, self.call_steps,
            )  # fmt: skip
        return fixed_step.advance_fixed(
            self.w[0], self.w[1], self.w[2], self.sliding, self.tau, *shared, *recorded, *rules,
            step, scene.duration, self.largest_force, self.call_steps,
        )  # fmt: skip

    def _settings(self) -> str:
        return f"dx = {self.scene.dx:g}, beta = {self.beta:g}, max_step = {self.scene.max_step:g}"

    def run(self, progress: Callable[[float], None] | None) -> int:
        """Advance to the end of the scene. Returns why the kernel stopped."""
        while True:
            before = float(self.totals[taylor.TIME])
            n = self.counts[taylor.RUNS]
            sliding = max(int(np.sum(self.ends[:n] - self.starts[:n])), 1)
            self.call_steps = int(min(max(CALL_WORK / sliding, 10), CALL_STEPS))
            least = self.call_steps * taylor.SIMULTANEOUS * self.scene.max_step * self.scene.dx
            status = self._advance()
            if status == taylor.GROW:
                self._grow()
            elif status == taylor.UNSTABLE:
                raise UnstableRun(
                    f"the run became unstable at t = {self.totals[taylor.TIME]:.6g}: slip velocity is not finite or"
                    f" beyond anything the pre-stress can drive ({self._settings()})"
                )
            elif status != taylor.CONTINUE:
                return status
            elif self.totals[taylor.TIME] - before < least:
                raise UnstableRun(
                    f"the run became unstable at t = {before:.6g}: it no longer advances, blocks stick and are"
                    f" released over and over at one instant ({self._settings()})"
                )
            if progress is not None:
                progress(min(1.0, self.totals[taylor.TIME] / self.scene.duration))

    def _energies(self) -> dict:
        """Energy balance per unit depth of the whole lattice, and its residual relative to the total."""
        dx = self.scene.dx
        size = self.w.shape[1]
        u, v = self.w[0], self.w[1]
        if self.localised:
            strain = self.strain
        else:
            strain = np.zeros(size)
            strain[:-1] = np.diff(u) / dx
        weight = np.full(size, 2.0 if self.mirror else 1.0)
        bond = weight.copy()
        if self.mirror:
            weight[0], weight[1] = 0.0, 1.0
            bond[0] = 0.0
        parts = {
            "work_of_prestress": float(np.sum(weight * self.tau * u) * dx),
            "kinetic_energy": float(0.5 * np.sum(weight * v * v) * dx),
            "elastic_energy": float(0.5 * np.sum(bond * strain * strain) * dx),
            "leaf_spring_energy": float(0.5 * self.leaf * np.sum(weight * u * u) * dx),
            "viscous_loss": float(self.totals[taylor.VISCOUS_LOSS]),
            "event_loss": float(self.totals[taylor.STICK_LOSS]),
        }
        stored = sum(value for key, value in parts.items() if key != "work_of_prestress")
        largest = max(abs(value) for value in parts.values())
        parts["energy_residual"] = abs(parts["work_of_prestress"] - stored) / largest if largest else 0.0
        return parts

    def _stress(self) -> np.ndarray:
        """Stress of every block at the end, damping included where the release rule includes it."""
        dx, (u, v) = self.scene.dx, self.w[:2]
        stress = self.tau - self.leaf * u
        if self.localised:
            stress[1:-1] += np.diff(self.strain[:-1]) / dx
        else:
            stress[1:-1] += np.diff(u, 2) / dx**2
        if self.scene.release == "total":
            stress[1:-1] += self.beta * np.diff(v, 2) / dx**2
        return stress

    def result(self, status: int) -> LatticeRun:
        """Close the run: last samples, energies, flags, and the lattice unfolded and trimmed."""
        scene = self.scene
        n = int(self.counts[taylor.RUNS])
        if self.localised:
            taylor.finish(
                self.w, self.strain, self.tau, self.starts, self.ends, self.counts, self.totals,
                self.mirror, scene.dx, self.leaf, self.beta,
            )  # fmt: skip
            self.sliding[:] = False
            for a, b in zip(self.starts[:n], self.ends[:n], strict=True):
                self.sliding[a:b] = True
        acceleration = np.where(self.sliding, self.w[2], 0.0)
        for s in range(int(self.counts[taylor.NEXT_SAMPLE]), self.sample_times.size):
            inside = self.sample_blocks >= 0
            if self.sample_times[s] > scene.duration:
                self.sample_slip[s] = self.sample_velocity[s] = np.nan
                continue
            self.sample_slip[s, inside] = self.w[0, self.sample_blocks[inside]]
            self.sample_velocity[s, inside] = self.w[1, self.sample_blocks[inside]]

        numbers = self._energies()
        released = np.isfinite(self.release_time)
        stuck_stress = self._stress()[1:-1][~self.sliding[1:-1]]
        lowest = float(min(self.totals[taylor.MIN_STUCK_STRESS], np.min(stuck_stress, initial=np.inf)))
        numbers |= {
            "end_time": float(self.totals[taylor.TIME]),
            "stopped_because": "everything is stuck" if status == taylor.ALL_STUCK else "duration reached",
            "steps": int(self.counts[taylor.STEPS]),
            "block_updates": int(self.counts[taylor.BLOCK_UPDATES]),
            "event_updates": int(self.counts[taylor.EVENT_UPDATES]),
            "releases": int(self.counts[taylor.RELEASES]),
            "sticks": int(self.counts[taylor.STICKS]),
            "re_releases": int(self.counts[taylor.RE_RELEASES]),
            "min_velocity": float(self.totals[taylor.MIN_VELOCITY]),
            "min_stuck_stress": lowest,
            "friction_ratio_needed": max(0.0, -(lowest + 1.0) / 2.0),
            "first_stick_time": float(self.totals[taylor.FIRST_STICK]),
            "first_stick_position": (
                float((self.counts[taylor.FIRST_STUCK] + self.first_block) * scene.dx)
                if self.counts[taylor.STICKS]
                else math.nan
            ),
            "half_lattice_used": int(self.mirror),
        }
        blocks = np.arange(self.w.shape[1]) + self.first_block
        keep = (blocks >= 0) if self.mirror else np.ones(blocks.size, dtype=bool)
        keep[0] = keep[-1] = False
        if released.any():
            outermost = blocks[released]
            keep &= (blocks >= outermost.min() - MARGIN) & (blocks <= outermost.max() + MARGIN)
        else:
            keep &= np.abs(blocks) <= MARGIN

        def unfold(values: np.ndarray) -> np.ndarray:
            kept = values[keep]
            return np.concatenate([kept[:0:-1], kept]) if self.mirror else kept.copy()

        kept_blocks = blocks[keep]
        numbers_of_blocks = np.concatenate([-kept_blocks[:0:-1], kept_blocks]) if self.mirror else kept_blocks
        return LatticeRun(
            x=numbers_of_blocks * scene.dx,
            prestress=unfold(self.tau),
            release_time=unfold(self.release_time),
            stick_time=unfold(self.stick_time),
            slip=unfold(self.w[0]),
            slip_velocity=unfold(self.w[1]),
            slip_acceleration=unfold(acceleration),
            sample_slip=self.sample_slip if self.samples else None,
            sample_velocity=self.sample_velocity if self.samples else None,
            numbers=numbers,
        )


def run_scene(
    scene: Scene,
    samples: Samples | None = None,
    progress: Callable[[float], None] | None = None,
    damping_sign: int = 1,
) -> LatticeRun:
    """Run a scene; ``damping_sign = -1`` is the sign as printed in the paper, which blows up."""
    lattice = Lattice(scene, samples, damping_sign * scene.beta)
    return lattice.result(lattice.run(progress))
