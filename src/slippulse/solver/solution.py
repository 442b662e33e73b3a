"""The solution of a scene: its fields, its energies and its counters.

When a lattice has reached the end of its scene, its arrays are unfolded (if only the half x >= 0
was solved) and cut to the blocks that slipped, with a margin.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ..model.samples import Samples
from ..model.scene import Scene
from .arrays import ACCELERATION, ALL_STUCK, SLIP, TALLY_DTYPE, VELOCITY
from .lattice import Lattice

# Number of blocks at rest that are kept beyond the outermost block that was released.
MARGIN_BLOCKS = 16
# Counters and extremes of the tally that a solution keeps.
KEPT_COUNTERS = (
    "steps",
    "block_updates",
    "event_updates",
    "releases",
    "sticks",
    "re_releases",
    "min_velocity",
)


@dataclass
class Solution:
    """The solution of a scene, by a lattice or exact, from the left to the right end."""

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
    flags: tuple[str, ...] = ()  # flags that only the solver can raise

    def arrays(self) -> dict[str, np.ndarray]:
        """Return the arrays by name."""
        return {name: value for name, value in vars(self).items() if isinstance(value, np.ndarray)}


def compute_energies(lattice: Lattice, totals: dict) -> dict:
    """Return the parts of the energy balance, per unit depth, and its residual.

    The residual is the energy that is missing, divided by the largest part.
    """
    medium, motion = lattice.medium, lattice.motion
    dx, strain = medium.dx, motion.strain
    slip, velocity = motion.w[SLIP], motion.w[VELOCITY]
    if not lattice.localised:
        strain = np.append(np.diff(slip) / dx, 0.0)
    # Weights of the blocks, and of the bonds between each block and the next one. On a mirrored
    # lattice each counts twice, except block 1 on the axis; block 0 is a mirror image.
    weight, bond = np.full((2, lattice.size), 2.0 if medium.is_mirrored else 1.0)
    if medium.is_mirrored:
        weight[0], weight[1] = 0.0, 1.0
        bond[0] = 0.0
    viscous_loss = totals["viscous_loss"]
    if medium.law_number:
        # Symplectic Euler is a leapfrog scheme. Its velocities belong to the time half a step
        # before that of its slip. Its viscous loss is summed with the velocities at the ends of
        # steps, so it is the loss until three quarters of a step after the time of the velocities.
        step = lattice.scene.max_step * dx
        slip = slip - 0.5 * step * velocity
        strain = np.append(np.diff(slip) / dx, 0.0)
        rates = np.append(np.diff(velocity) / dx, 0.0)
        viscous_loss -= 0.75 * step * medium.beta * float(np.sum(bond * rates * rates) * dx)
    parts = {
        "work_of_prestress": float(np.sum(weight * motion.tau * slip) * dx),
        "kinetic_energy": float(0.5 * np.sum(weight * velocity * velocity) * dx),
        "elastic_energy": float(0.5 * np.sum(bond * strain * strain) * dx),
        "leaf_spring_energy": float(
            0.5 * medium.leaf_stiffness * np.sum(weight * slip * slip) * dx
        ),
        "viscous_loss": viscous_loss,
        "event_loss": totals["stick_loss"],
        "friction_loss": totals["friction_loss"],
    }
    work, *others = parts.values()
    missing = abs(work - sum(others))
    largest = max(map(abs, parts.values()))
    return parts | {"energy_residual": missing / largest if largest else 0.0}


def compute_numbers(lattice: Lattice, status: int) -> dict:
    """Return energies, counters and extremes of a simulation that has ended.

    ``status`` is the reason why the kernel stopped.
    """
    totals = dict(zip(TALLY_DTYPE.names or (), lattice.tally.tolist(), strict=True))
    medium, motion = lattice.medium, lattice.motion
    dx = medium.dx
    slip, velocity = motion.w[SLIP], motion.w[VELOCITY]
    # The stress at the end, of all blocks except the ghost blocks.
    elastic = np.diff(motion.strain[:-1]) / dx if lattice.localised else np.diff(slip, 2) / dx**2
    stress = (motion.tau - medium.leaf_stiffness * slip)[1:-1] + elastic
    if medium.damping_counts_for_release:
        stress += medium.beta * np.diff(velocity, 2) / dx**2
    is_stuck = ~lattice.sliding[1:-1]
    lowest = float(np.min(stress[is_stuck], initial=totals["min_stuck_stress"]))
    # A block would slide backwards at a stress of -(1 + 2 mu_k/(mu_s - mu_k)).
    friction_ratio_needed = max(0.0, -(lowest + 1.0) / 2.0)
    first_stuck = (totals["first_stuck_block"] + lattice.first_block) * dx
    return compute_energies(lattice, totals) | {
        "end_time": totals["time"],
        "stopped_because": "everything is stuck" if status == ALL_STUCK else "duration reached",
        **{name: totals[name] for name in KEPT_COUNTERS},
        "min_stuck_stress": lowest,
        "friction_ratio_needed": friction_ratio_needed,
        "first_stick_time": totals["first_stick_time"],
        "first_stick_position": float(first_stuck) if totals["sticks"] else math.nan,
        "half_lattice_used": int(lattice.is_mirrored),
    }


def extract_solution(lattice: Lattice, status: int) -> Solution:
    """Return the solution of a lattice whose kernel stopped for the reason ``status``."""
    motion, history = lattice.motion, lattice.history
    recorder = lattice.recorder
    # If the kernel stopped early, the lattice is at rest at the times of all missing samples.
    inside = recorder.blocks >= 0
    rest = slice(lattice.tally.samples_taken, None)
    recorder.slip[rest, inside] = motion.w[SLIP, recorder.blocks[inside]]
    recorder.velocity[rest, inside] = motion.w[VELOCITY, recorder.blocks[inside]]
    blocks = np.arange(lattice.size) + lattice.first_block
    released = blocks[np.isfinite(history.release_time)]
    first, last = 0, 0
    if released.size:
        first, last = released.min(), released.max()
    keep = (blocks >= first - MARGIN_BLOCKS) & (blocks <= last + MARGIN_BLOCKS)
    if lattice.is_mirrored:
        keep &= blocks >= 0
    # The ghost blocks are not part of the solution.
    keep[0] = keep[-1] = False

    def unfold(values: np.ndarray, sign: int = 1) -> np.ndarray:
        """Return the kept blocks, with their mirror images times a sign if half was solved."""
        kept = values[keep]
        if not lattice.is_mirrored:
            return kept.copy()
        mirror_images = sign * kept[:0:-1]
        return np.concatenate([mirror_images, kept])

    return Solution(
        x=unfold(blocks, -1) * lattice.scene.dx,
        prestress=unfold(motion.tau),
        release_time=unfold(history.release_time),
        stick_time=unfold(history.stick_time),
        slip=unfold(motion.w[SLIP]),
        slip_velocity=unfold(motion.w[VELOCITY]),
        slip_acceleration=unfold(np.where(lattice.sliding, motion.w[ACCELERATION], 0.0)),
        numbers=compute_numbers(lattice, status),
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
    """Solve a scene on a lattice.

    With ``damping_sign = -1``, damping has the sign that is printed in the paper, and blows up.
    """
    lattice = kind(scene, samples, damping_sign * scene.beta)
    return extract_solution(lattice, lattice.advance_to_end(progress))
