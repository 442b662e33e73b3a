"""The solution of a scene: its fields, its energies and its counters.

When a lattice has reached the end of its scene, its arrays are cut to the blocks that slipped, with
a margin. If only the half x >= 0 was solved, they are also extended by their mirror images.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..model.samples import Samples
from ..model.scene import Scene
from .arrays import ACCELERATION, ALL_STUCK, SLIP, TALLY_DTYPE, VELOCITY, Medium
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

    totals : fields of the lattice's tally by name, among them the losses
    """
    medium, motion = lattice.medium, lattice.motion
    dx = medium.dx
    slip, velocity = motion.derivatives[SLIP], motion.derivatives[VELOCITY]
    strain = motion.strain if lattice.localised else _gradient(slip, dx)
    weights = _block_weights(lattice)
    viscous_loss = totals["viscous_loss"]
    if medium.law_number:
        # Laws that have a number are not linear in slip velocity, and are solved by symplectic
        # Euler. In this scheme, velocities belong to the time half a step before that of the slip.
        # The slip is moved back to this time, at which the energies are computed.
        step = lattice.scene.max_step * dx
        slip = slip - 0.5 * step * velocity
        strain = _gradient(slip, dx)
        strain_rate = _gradient(velocity, dx)
        # The scheme uses the velocities at the end of each step, and so overestimates this loss.
        viscous_loss -= _overestimate_of_viscous_loss(strain_rate, weights.bonds, step, medium)
    parts = {
        "work_of_prestress": float(np.sum(weights.blocks * motion.tau * slip) * dx),
        "kinetic_energy": float(0.5 * np.sum(weights.blocks * velocity * velocity) * dx),
        "elastic_energy": float(0.5 * np.sum(weights.bonds * strain * strain) * dx),
        "leaf_spring_energy": float(
            0.5 * medium.leaf_stiffness * np.sum(weights.blocks * slip * slip) * dx
        ),
        "viscous_loss": viscous_loss,
        "event_loss": totals["stick_loss"],
        "friction_loss": totals["friction_loss"],
    }
    work, *energies_and_losses = parts.values()
    missing = abs(work - sum(energies_and_losses))
    largest = max(map(abs, parts.values()))
    return parts | {"energy_residual": missing / largest if largest else 0.0}


def _gradient(values: np.ndarray, dx: float) -> np.ndarray:
    """Return the gradient between each block and the next one; 0 for the last block."""
    return np.append(np.diff(values) / dx, 0.0)


class Weights(NamedTuple):
    """Numbers of times that each block, and the bond between it and the next one, is counted."""

    blocks: np.ndarray
    bonds: np.ndarray


def _block_weights(lattice: Lattice) -> Weights:
    """Return the weights of blocks and bonds in a sum over the whole lattice.

    Bond i joins block i and block i + 1. On a mirrored lattice each counts twice, because it has a
    mirror image. Block 1 on the axis counts once. Block 0 and bond 0 are mirror images themselves
    and do not count.
    """
    if not lattice.is_mirrored:
        return Weights(np.ones(lattice.size), np.ones(lattice.size))
    blocks, bonds = np.full(lattice.size, 2.0), np.full(lattice.size, 2.0)
    blocks[0], blocks[1] = 0.0, 1.0
    bonds[0] = 0.0
    return Weights(blocks, bonds)


def _overestimate_of_viscous_loss(
    strain_rate: np.ndarray, bond_weights: np.ndarray, step: float, medium: Medium
) -> float:
    """Return the amount by which symplectic Euler overestimates the viscous loss of a run.

    Let D_0 and D_1 be the dissipation at the start and at the end of a step of length h. The scheme
    counts h D_1. However, the damping force contains the velocity at the start of the step, and
    acts over the mean velocity. The loss is therefore h (3 D_0 + D_1)/4, and 3 h (D_1 - D_0)/4
    less than counted. Since a run starts at rest, these differences add up to 3 h D_1/4, where D_1
    is the dissipation at the end of the run.

    strain_rate : between each block and the next one (a bond), at the end
    bond_weights : 2 if a bond has a mirror image that is not in the arrays, 0 if it is one, else 1
    step : length of the steps
    """
    dissipation_divided_by_beta = float(
        np.sum(bond_weights * strain_rate * strain_rate) * medium.dx
    )
    return 0.75 * step * medium.beta * dissipation_divided_by_beta


def _first_stuck_block(lattice: Lattice) -> int:
    """Return the number of the block that stuck first, counted from 0 at x = 0.

    Several blocks stick first at the same time if the scheme checks this only once in each step.
    The one nearest to x = 0 is returned and, of two mirror images, the one on the right.
    """
    is_first = lattice.history.stick_time == lattice.tally.first_stick_time
    blocks = np.flatnonzero(is_first) + lattice.first_block
    if not blocks.size:
        # The block that stuck first was released again, so that it has no stick time.
        return int(lattice.tally.first_stuck_block) + lattice.first_block
    distances = np.abs(blocks)
    return int(np.max(blocks[distances == np.min(distances)]))


def compute_numbers(lattice: Lattice, status: int) -> dict:
    """Return energies, counters and extremes of a simulation that has ended.

    status : the reason why the kernel stopped
    """
    # The fields of the record with the totals of the run, by name.
    totals = dict(zip(TALLY_DTYPE.names or (), lattice.tally.tolist(), strict=True))
    medium, motion = lattice.medium, lattice.motion
    dx = medium.dx
    slip, velocity = motion.derivatives[SLIP], motion.derivatives[VELOCITY]
    # The stress at the end, of all blocks except the ghost blocks. Only the localised scheme keeps
    # the strain, which is more accurate than differences of slip.
    elastic = np.diff(motion.strain[:-1]) / dx if lattice.localised else np.diff(slip, 2) / dx**2
    stress = (motion.tau - medium.leaf_stiffness * slip)[1:-1] + elastic
    if medium.damping_counts_for_release:
        stress += medium.beta * np.diff(velocity, 2) / dx**2
    is_stuck = ~lattice.sliding[1:-1]
    # The kernel has recorded the lowest stress that a stuck block had during the run.
    lowest_stress = float(np.min(stress[is_stuck], initial=totals["min_stuck_stress"]))
    # A block slides backwards at the stress -(1 + 2 r) if r is the friction ratio,
    # mu_k/(mu_s - mu_k). At this ratio, the block of the lowest stress would just do so.
    friction_ratio_needed = max(0.0, -(lowest_stress + 1.0) / 2.0)
    first_stuck_position = _first_stuck_block(lattice) * dx
    return compute_energies(lattice, totals) | {
        "end_time": totals["time"],
        "stopped_because": "everything is stuck" if status == ALL_STUCK else "duration reached",
        **{name: totals[name] for name in KEPT_COUNTERS},
        "min_stuck_stress": lowest_stress,
        "friction_ratio_needed": friction_ratio_needed,
        "first_stick_time": totals["first_stick_time"],
        "first_stick_position": float(first_stuck_position) if totals["sticks"] else math.nan,
        "half_lattice_used": int(lattice.is_mirrored),
    }


def extract_solution(lattice: Lattice, status: int) -> Solution:
    """Return the solution of a lattice whose kernel stopped for the reason ``status``."""
    motion, history = lattice.motion, lattice.history
    _fill_missing_samples(lattice)
    # Numbers of the blocks, from 0 at x = 0. Those from the first to the last released one are
    # kept, with a margin.
    blocks = np.arange(lattice.size) + lattice.first_block
    released = blocks[np.isfinite(history.release_time)]
    first, last = 0, 0
    if released.size:
        first, last = released.min(), released.max()
    is_kept = (blocks >= first - MARGIN_BLOCKS) & (blocks <= last + MARGIN_BLOCKS)
    if lattice.is_mirrored:
        is_kept &= blocks >= 0
    # The ghost blocks are not part of the solution.
    is_kept[0] = is_kept[-1] = False

    def unfold(values: np.ndarray, sign: int = 1) -> np.ndarray:
        """Return the values of the kept blocks, and before them those of their mirror images.

        sign : factor of the values of mirror images
        """
        kept = values[is_kept]
        if not lattice.is_mirrored:
            return kept.copy()
        # The first kept block lies at x = 0 and has no mirror image.
        mirror_images = sign * kept[:0:-1]
        return np.concatenate([mirror_images, kept])

    return Solution(
        x=unfold(blocks, -1) * lattice.scene.dx,
        prestress=unfold(motion.tau),
        release_time=unfold(history.release_time),
        stick_time=unfold(history.stick_time),
        slip=unfold(motion.derivatives[SLIP]),
        slip_velocity=unfold(motion.derivatives[VELOCITY]),
        slip_acceleration=unfold(np.where(lattice.sliding, motion.derivatives[ACCELERATION], 0.0)),
        numbers=compute_numbers(lattice, status),
        sample_slip=lattice.recorder.slip if lattice.samples else None,
        sample_velocity=lattice.recorder.velocity if lattice.samples else None,
    )


def _fill_missing_samples(lattice: Lattice) -> None:
    """Fill in the samples that the kernel has not taken, because all blocks stuck before.

    At their times the lattice is at rest in its final state. If the kernel did not stop early, it
    has taken all samples, and nothing is changed.
    """
    recorder, motion = lattice.recorder, lattice.motion
    missing_times = slice(lattice.tally.samples_taken, None)
    has_block = recorder.blocks >= 0
    sampled_blocks = recorder.blocks[has_block]
    recorder.slip[missing_times, has_block] = motion.derivatives[SLIP, sampled_blocks]
    recorder.velocity[missing_times, has_block] = motion.derivatives[VELOCITY, sampled_blocks]


def solve_on_lattice(
    scene: Scene,
    samples: Samples | None = None,
    progress: Callable[[float], None] | None = None,
    damping_sign: int = 1,
    lattice_type: type[Lattice] = Lattice,
) -> Solution:
    """Solve a scene on a lattice.

    progress : function that is called now and then with the fraction of the duration done
    damping_sign : with -1, damping has the sign that is printed in the paper, and the run blows up
    lattice_type : class of the lattice, which determines the scheme
    """
    lattice = lattice_type(scene, samples, damping_sign * scene.beta)
    status = lattice.advance_to_end(progress)
    return extract_solution(lattice, status)
