"""What the kernels work on: arrays, constants and counters, in groups.

Shapes: K = order + 2 derivatives of slip (rows 0 to order + 1), N blocks of the lattice, the ghost block at each end
included. Lengths are in units of H, times in units of H over the wave speed, stresses in units of the stress drop.
"""

from typing import NamedTuple

import numpy as np

# Reach of an event on either side at order 8, the highest: one block for each derivative from the third on.
REACH = 7
# Columns of the difference that an event makes: its reach on either side of its centre, a block at rest at each end.
CENTRE = REACH + 1
COLUMNS = 2 * CENTRE + 1
# A step ends early at the next event after this many.
MOST_EVENTS = 64
# Blocks that must be left beyond the outermost sliding one, for the events of one step.
ROOM = COLUMNS + MOST_EVENTS

# Why a kernel returned.
DONE, CONTINUE, GROW, UNSTABLE, ALL_STUCK = 0, 1, 2, 3, 4

# Records whose fields are attributes, for kernels and for Python alike. One dtype object for each kind: numba knows it
# again by its address, and would find the type of a copy anew in each call.
# pending_step: the step whose viscous loss still lacks the part of the dissipation at its end.
_FLOATS = "time first_stick_time pending_step viscous_loss stick_loss min_velocity min_stuck_stress"
_COUNTS = (
    "steps block_updates event_updates samples_taken releases re_releases sticks first_stuck_block"
)
_FIELDS = [(name, np.float64) for name in _FLOATS.split()] + [
    (name, np.int64) for name in _COUNTS.split()
]
TALLY = np.dtype((np.record, _FIELDS))
COUNT = np.dtype((np.record, [("n", np.int64)]))
# Sums over the events of a step of k, k s and k s^2: the event at time s changes dD/dt, D the dissipation, by k.
KINKS = np.dtype((np.record, [("k", np.float64), ("ks", np.float64), ("kss", np.float64)]))


def record(kind: np.dtype) -> np.record:
    """One record of zeros."""
    return np.zeros(1, dtype=kind)[0]


class Medium(NamedTuple):
    """Constants of the equation of motion and of the release rule."""

    dx: float
    per_dx: float  # 1/dx
    per_dx2: float  # 1/dx^2
    leaf: float  # Gamma gamma
    beta: float
    damping: float  # beta/dx^2
    alpha: float  # rate strengthening of friction
    mirror: bool  # block 1 lies at x = 0 and block 0 is the mirror image of block 2
    total: bool  # the stress that is compared with 1 includes the damping force


class Motion(NamedTuple):
    """State of the blocks; everything at rest is 0."""

    w: np.ndarray  # (K, N), time derivatives of slip u at the start of the step: w[0] = u, w[1] = v
    offset: np.ndarray  # (N,), change of w[0] by the events of this step, added at its end
    velocity: np.ndarray  # (N,), slip velocity at the end of the step
    strain: np.ndarray  # (N,), (u_{i+1} - u_i)/dx
    tau: np.ndarray  # (N,), pre-stress


class Segments(NamedTuple):
    """Contiguous stretches of sliding blocks [start, end), in order; ``count.n`` of them."""

    starts: np.ndarray
    ends: np.ndarray
    count: np.record  # type: ignore[assignment]


class Event(NamedTuple):
    """The release of a block, or its stick, a time after the start of the step."""

    block: int
    time: float
    stick: bool


class Forecast(NamedTuple):
    """Events foreseen within the step."""

    release: (
        np.ndarray
    )  # (N,), time of each stuck neighbour of a segment; inf: none, or a mirror image
    stick_block: np.ndarray  # (N,), blocks that stick, the first ``sticks.n`` entries
    stick_time: np.ndarray  # (N,)
    sticks: np.record
    coefficients: np.ndarray  # (K,), scratch: a polynomial
    slopes: np.ndarray  # (K,), scratch: its derivative


class Difference(NamedTuple):
    """Scratch of an event: what it changes in the blocks within its reach."""

    rows: np.ndarray  # (K, COLUMNS), time derivatives at the event of the change of slip
    own: np.ndarray  # (K + 2,), those of the block of the event
    values: np.ndarray  # (COLUMNS,)


class Changed(NamedTuple):
    """Blocks changed by each event of a step; ``count.n`` events."""

    first: np.ndarray
    last: np.ndarray  # the one after the last
    stuck: np.ndarray  # the block that stuck, -1: a release
    count: np.record  # type: ignore[assignment]
    kinks: np.record


class Scratch(NamedTuple):
    """Everything that lasts for one step."""

    moved: Segments  # all blocks that slid at any time of the step
    forecast: Forecast
    difference: Difference
    changed: Changed


class History(NamedTuple):
    """What is known of the run so far."""

    release_time: np.ndarray  # (N,), first release; NaN: none
    stick_time: np.ndarray  # (N,), last stick; NaN: none, or released again
    tally: np.record


class Recorder(NamedTuple):
    """Samples of slip and slip velocity: T times, P blocks."""

    times: np.ndarray  # (T,)
    blocks: np.ndarray  # (P,), -1: outside the lattice, at rest
    slip: np.ndarray  # (T, P)
    velocity: np.ndarray  # (T, P)


class Limits(NamedTuple):
    """The step, and how far to go."""

    order: int
    largest_step: float
    end_time: float
    largest_force: float  # largest |tau|
    steps: int  # in one call


def make_motion(rows: int, size: int) -> Motion:
    """Everything at rest, in one block of memory, so that all rows begin a known distance apart, see `lattice.PAGE`."""
    block = np.zeros((rows + 4, size))
    return Motion(block[:rows], *block[rows:])


def make_segments(size: int) -> Segments:
    """No segments, on a lattice of ``size`` blocks."""
    starts, ends = np.zeros((2, size), dtype=np.int64)
    return Segments(starts, ends, record(COUNT))


def make_forecast(size: int, order: int) -> Forecast:
    """No events, on a lattice of ``size`` blocks."""
    release, block, time = np.full(size, np.inf), np.zeros(size, dtype=np.int64), np.zeros(size)
    return Forecast(release, block, time, record(COUNT), *np.zeros((2, order + 2)))


def make_scratch(size: int, order: int) -> Scratch:
    """Scratch arrays of a lattice of ``size`` blocks."""
    first, last, stuck = np.zeros((3, MOST_EVENTS), dtype=np.int64)
    return Scratch(
        make_segments(size),
        make_forecast(size, order),
        Difference(np.zeros((order + 2, COLUMNS)), np.zeros(order + 4), np.zeros(COLUMNS)),
        Changed(first, last, stuck, record(COUNT), record(KINKS)),
    )


def make_medium(
    dx: float, leaf: float, beta: float, mirror: bool, total: bool, alpha: float = 0.0
) -> Medium:
    """Constants of one run."""
    return Medium(dx, 1.0 / dx, 1.0 / (dx * dx), leaf, beta, beta / (dx * dx), alpha, mirror, total)
