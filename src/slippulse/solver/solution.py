"""The solution of a scene: energies, counters, and the lattice unfolded and trimmed."""

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
# Counters and extremes of the tally that are kept as they are.
KEPT = "steps block_updates event_updates releases sticks re_releases min_velocity"


@dataclass
class Solution:
    """The solution of a scene, of a lattice or exact, from the left to the right end."""

    x: np.ndarray
    prestress: np.ndarray
    release_time: np.ndarray
    stick_time: np.ndarray
    slip: np.ndarray
    slip_velocity: np.ndarray
    slip_acceleration: np.ndarray
    numbers: dict
    sample_slip: np.ndarray | None = None
    sample_velocity: np.ndarray | None = None
    flags: tuple[str, ...] = ()  # those that only its solver can raise

    def arrays(self) -> dict[str, np.ndarray]:
        """The arrays by name."""
        return {name: value for name, value in vars(self).items() if isinstance(value, np.ndarray)}


def energies(lattice: Lattice, totals: dict) -> dict:
    """Energy balance of the lattice per unit depth, and its residual over the largest part."""
    medium, motion = lattice.medium, lattice.motion
    dx, strain = medium.dx, motion.strain
    slip, velocity = motion.w[0], motion.w[1]
    if not lattice.localised:
        strain = np.append(np.diff(slip) / dx, 0.0)
    weight, bond = np.full((2, lattice.size), 2.0 if medium.mirror else 1.0)
    if medium.mirror:
        weight[:2], bond[0] = (0.0, 1.0), 0.0
    viscous_loss = totals["viscous_loss"]
    if medium.law:
        # Symplectic Euler is leapfrog: its velocity is that of half a step before, and its viscous
        # loss, summed with velocities at the ends of steps, is that of three quarters later.
        step = lattice.scene.max_step * dx
        slip = slip - 0.5 * step * velocity
        strain = np.append(np.diff(slip) / dx, 0.0)
        rates = np.append(np.diff(velocity) / dx, 0.0)
        viscous_loss -= 0.75 * step * medium.beta * float(np.sum(bond * rates * rates) * dx)
    parts = {
        "work_of_prestress": float(np.sum(weight * motion.tau * slip) * dx),
        "kinetic_energy": float(0.5 * np.sum(weight * velocity * velocity) * dx),
        "elastic_energy": float(0.5 * np.sum(bond * strain * strain) * dx),
        "leaf_spring_energy": float(0.5 * medium.leaf * np.sum(weight * slip * slip) * dx),
        "viscous_loss": viscous_loss,
        "event_loss": totals["stick_loss"],
        "friction_loss": totals["friction_loss"],
    }
    work, *others = parts.values()
    largest = max(map(abs, parts.values()))
    return parts | {"energy_residual": abs(work - sum(others)) / largest if largest else 0.0}


def numbers_of(lattice: Lattice, status: int) -> dict:
    """Energies, counters and extremes of a simulation that ended with a status of the kernel."""
    totals = dict(zip(TALLY.names or (), lattice.tally.tolist(), strict=True))
    medium, motion = lattice.medium, lattice.motion
    dx = medium.dx
    slip, velocity = motion.w[0], motion.w[1]
    elastic = np.diff(motion.strain[:-1]) / dx if lattice.localised else np.diff(slip, 2) / dx**2
    stress = (motion.tau - medium.leaf * slip)[1:-1] + elastic
    if medium.total:
        stress += medium.beta * np.diff(velocity, 2) / dx**2
    stuck = ~lattice.sliding[1:-1]
    lowest = float(np.min(stress[stuck], initial=totals["min_stuck_stress"]))
    first_stuck = (totals["first_stuck_block"] + lattice.first_block) * dx
    return energies(lattice, totals) | {
        "end_time": totals["time"],
        "stopped_because": "everything is stuck" if status == ALL_STUCK else "duration reached",
        **{name: totals[name] for name in KEPT.split()},
        "min_stuck_stress": lowest,
        "friction_ratio_needed": max(0.0, -(lowest + 1.0) / 2.0),
        "first_stick_time": totals["first_stick_time"],
        "first_stick_position": float(first_stuck) if totals["sticks"] else math.nan,
        "half_lattice_used": int(lattice.mirror),
    }


def solution_of(lattice: Lattice, status: int) -> Solution:
    """The solution of a lattice whose kernel ended with a status."""
    motion, history, recorder = lattice.motion, lattice.history, lattice.recorder
    # After a kernel that stopped early, the samples that it did not take are of a lattice at rest.
    inside = recorder.blocks >= 0
    rest = slice(lattice.tally.samples_taken, None)
    recorder.slip[rest, inside] = motion.w[0, recorder.blocks[inside]]
    recorder.velocity[rest, inside] = motion.w[1, recorder.blocks[inside]]
    blocks = np.arange(lattice.size) + lattice.first_block
    released = blocks[np.isfinite(history.release_time)]
    first, last = (released.min(), released.max()) if released.size else (0, 0)
    keep = (blocks >= first - MARGIN) & (blocks <= last + MARGIN)
    if lattice.mirror:
        keep &= blocks >= 0
    # The ghosts.
    keep[0] = keep[-1] = False

    def unfold(values: np.ndarray, sign: int = 1) -> np.ndarray:
        kept = values[keep]
        return np.concatenate([sign * kept[:0:-1], kept]) if lattice.mirror else kept.copy()

    return Solution(
        x=unfold(blocks, -1) * lattice.scene.dx,
        prestress=unfold(motion.tau),
        release_time=unfold(history.release_time),
        stick_time=unfold(history.stick_time),
        slip=unfold(motion.w[0]),
        slip_velocity=unfold(motion.w[1]),
        slip_acceleration=unfold(np.where(lattice.sliding, motion.w[2], 0.0)),
        numbers=numbers_of(lattice, status),
        sample_slip=recorder.slip if lattice.samples else None,
        sample_velocity=recorder.velocity if lattice.samples else None,
    )


def solve_on_lattice(
    scene: Scene,
    samples: Samples | None = None,
    progress: Callable[[float], None] | None = None,
    damping_sign: int = 1,
    kind: type[Lattice] = Lattice,
) -> Solution:
    """Solve a scene; ``damping_sign = -1`` gives damping the sign printed, which blows up."""
    lattice = kind(scene, samples, damping_sign * scene.beta)
    return solution_of(lattice, lattice.advance_to_end(progress))
