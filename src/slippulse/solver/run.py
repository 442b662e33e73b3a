"""A run, and what it leaves behind: energies, counters, and the lattice unfolded and trimmed."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..model.samples import Samples
from ..model.scene import Scene
from .arrays import ALL_STUCK, TALLY
from .lattice import Lattice

# Blocks at rest that are kept beyond the outermost released one.
MARGIN = 16
# Of the tally, as they are.
COUNTED = (
    "steps",
    "block_updates",
    "event_updates",
    "releases",
    "sticks",
    "re_releases",
    "min_velocity",
)


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
    numbers: dict


def energies(lattice: Lattice, totals: dict) -> dict:
    """Energy balance per unit depth of the whole lattice, and its residual relative to the largest part."""
    medium, motion, size = lattice.medium, lattice.motion, lattice.size
    dx, u, v = medium.dx, motion.w[0], motion.w[1]
    strain = motion.strain
    if not lattice.localised:
        strain = np.append(np.diff(u) / dx, 0.0)
    weight, bond = np.full((2, size), 2.0 if medium.mirror else 1.0)
    if medium.mirror:
        weight[:2], bond[0] = (0.0, 1.0), 0.0
    parts = {
        "work_of_prestress": float(np.sum(weight * motion.tau * u) * dx),
        "kinetic_energy": float(0.5 * np.sum(weight * v * v) * dx),
        "elastic_energy": float(0.5 * np.sum(bond * strain * strain) * dx),
        "leaf_spring_energy": float(0.5 * medium.leaf * np.sum(weight * u * u) * dx),
        "viscous_loss": totals["viscous_loss"],
        "event_loss": totals["stick_loss"],
    }
    work, *stored = parts.values()
    largest = max(map(abs, parts.values()))
    return parts | {"energy_residual": abs(work - sum(stored)) / largest if largest else 0.0}


def numbers_of(lattice: Lattice, status: int) -> dict:
    """Energies, counters and extremes of a run."""
    totals = dict(zip(TALLY.names or (), lattice.tally.tolist(), strict=True))
    medium, motion = lattice.medium, lattice.motion
    dx, u, v = medium.dx, motion.w[0], motion.w[1]
    # Of every block but the ghosts, damping included where the release rule includes it.
    elastic = np.diff(motion.strain[:-1]) / dx if lattice.localised else np.diff(u, 2) / dx**2
    stress = (motion.tau - medium.leaf * u)[1:-1] + elastic
    if medium.total:
        stress += medium.beta * np.diff(v, 2) / dx**2
    lowest = float(np.min(stress[~lattice.sliding[1:-1]], initial=totals["min_stuck_stress"]))
    first_stuck = (totals["first_stuck_block"] + lattice.first_block) * lattice.scene.dx
    return energies(lattice, totals) | {
        "end_time": totals["time"],
        "stopped_because": "everything is stuck" if status == ALL_STUCK else "duration reached",
        **{key: totals[key] for key in COUNTED},
        "min_stuck_stress": lowest,
        "friction_ratio_needed": max(0.0, -(lowest + 1.0) / 2.0),
        "first_stick_time": totals["first_stick_time"],
        "first_stick_position": float(first_stuck) if totals["sticks"] else math.nan,
        "half_lattice_used": int(lattice.mirror),
    }


def kept_blocks(lattice: Lattice) -> np.ndarray:
    """Mask of the blocks that are kept: those released and a margin; without ghosts."""
    blocks = np.arange(lattice.size) + lattice.first_block
    released = blocks[np.isfinite(lattice.history.release_time)]
    first, last = (released.min(), released.max()) if released.size else (0, 0)
    keep = (
        (blocks >= first - MARGIN)
        & (blocks <= last + MARGIN)
        & ((blocks >= 0) | (not lattice.mirror))
    )
    keep[0] = keep[-1] = False
    return keep


def assemble(lattice: Lattice, status: int) -> LatticeRun:
    """The result of a run whose kernel has stopped for the reason ``status``."""
    if lattice.localised:
        lattice.sliding[:] = False
        n = lattice.segments.count.n
        for a, b in zip(lattice.segments.starts[:n], lattice.segments.ends[:n], strict=True):
            lattice.sliding[a:b] = True
    motion, history, recorder = lattice.motion, lattice.history, lattice.recorder
    # Samples that a run that stopped early did not take: all is at rest.
    inside = recorder.blocks >= 0
    for n in range(lattice.tally.samples_taken, recorder.times.size):
        recorder.slip[n, inside], recorder.velocity[n, inside] = motion.w[
            :2, recorder.blocks[inside]
        ]
    keep = kept_blocks(lattice)

    def unfold(values: np.ndarray, sign: int = 1) -> np.ndarray:
        kept = values[keep]
        return np.concatenate([sign * kept[:0:-1], kept]) if lattice.mirror else kept.copy()

    return LatticeRun(
        x=unfold(np.arange(lattice.size) + lattice.first_block, -1) * lattice.scene.dx,
        prestress=unfold(motion.tau),
        release_time=unfold(history.release_time),
        stick_time=unfold(history.stick_time),
        slip=unfold(motion.w[0]),
        slip_velocity=unfold(motion.w[1]),
        slip_acceleration=unfold(np.where(lattice.sliding, motion.w[2], 0.0)),
        sample_slip=recorder.slip if lattice.samples else None,
        sample_velocity=recorder.velocity if lattice.samples else None,
        numbers=numbers_of(lattice, status),
    )


def run_scene(
    scene: Scene,
    samples: Samples | None = None,
    progress: Callable[[float], None] | None = None,
    damping_sign: int = 1,
    kind: type[Lattice] = Lattice,
) -> LatticeRun:
    """Run a scene by the localised scheme; ``damping_sign = -1`` is as printed in the paper, and blows up."""
    lattice = kind(scene, samples, damping_sign * scene.beta)
    return assemble(lattice, lattice.run(progress))
