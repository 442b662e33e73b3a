"""Arrays, constants and counters of the kernels, in groups.

Shapes: K = order + 2 derivatives of slip (rows 0 to order + 1), N blocks of the lattice, with the
ghost block at each end. Lengths are in units of H, times in units of H over the wave speed,
stresses in units of the stress drop.
"""

from typing import NamedTuple

import numpy as np

from ..model.friction_laws.law import LawKink

# At order 8, the highest, an event reaches this far on either side: one block for each derivative
# from the third on.
REACH = 7
# The difference that an event makes has its reach on either side of its centre, and a block at rest
# at each end.
CENTRE = REACH + 1
COLUMNS = 2 * CENTRE + 1
# After this number of events, a step ends early at the next one.
MOST_EVENTS = 64
# The events of one step need this number of blocks beyond the outermost sliding one.
ROOM = COLUMNS + MOST_EVENTS

# A kernel returns the reason why it stopped. CONTINUE: all steps of the call are done.
DONE = 0
CONTINUE = 1
GROW = 2
UNSTABLE = 3
ALL_STUCK = 4

# Kernels and Python read the fields of these records as attributes. There is one dtype object of
# each kind: numba recognises it by its address, and would find the type of a copy in each call.
# The viscous loss of pending_step still lacks the part of the dissipation at its end.
_FLOATS = (
    "time first_stick_time pending_step viscous_loss stick_loss friction_loss min_velocity"
    " min_stuck_stress"
)
_COUNTS = (
    "steps block_updates event_updates samples_taken releases re_releases sticks first_stuck_block"
)
_TYPES = dict.fromkeys(_FLOATS.split(), "f8") | dict.fromkeys(_COUNTS.split(), "i8")
TALLY = np.dtype((np.record, [*_TYPES.items()]))
COUNT = np.dtype((np.record, [("n", np.int64)]))
# The event at time s of a step changes dD/dt, where D is the dissipation, by k. These are the sums
# over the events of k, k s and k s^2.
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
    alpha: float  # friction that is linear in slip rate
    law: int  # number of another law of friction, 0: none
    first: float  # its parameters
    second: float
    bend: LawKink | None  # friction that is piecewise linear, in the Taylor step
    mirror: bool  # block 1 lies at x = 0 and block 0 is the mirror image of block 2
    total: bool  # the stress that is compared with 1 includes the damping force


class Motion(NamedTuple):
    """State of the blocks; everything at rest is 0."""

    # (K, N), time derivatives of slip at the start of the step: slip w[0], velocity w[1], ...
    w: np.ndarray
    offset: np.ndarray  # (N,), change of w[0] by the events of this step, added at its end
    velocity: np.ndarray  # (N,), slip velocity at the end of the step
    strain: np.ndarray  # (N,), (u_{i+1} - u_i)/dx
    tau: np.ndarray  # (N,), pre-stress
    # Of laws of friction other than those of no and of linear rate dependence:
    falls: np.ndarray  # (N,), slope of the friction of a block before its bend, 0 beyond
    resists: np.ndarray  # (N,), 1 where the law holds, 0 where the rupture is nucleated without it
    released: np.ndarray  # (N,), slip at the last release


class Segments(NamedTuple):
    """Contiguous stretches of sliding blocks [start, end), in order; ``count.n`` of them."""

    edges: np.ndarray  # (N,), start, end, start, end, ...
    count: np.record  # type: ignore[assignment]


class Event(NamedTuple):
    """The release of a block, its stick or the bend of its friction, and when in the step."""

    block: int
    time: float
    stick: bool
    bends: bool


class Forecast(NamedTuple):
    """Events foreseen within the step."""

    # (N,), release time of each stuck neighbour of a segment; inf: none, or a mirror image
    release: np.ndarray
    stick_block: np.ndarray  # (2 N,), blocks that stick, the first ``sticks.n`` entries
    stick_time: np.ndarray  # (2 N,)
    bends: np.ndarray  # (2 N,), True where friction bends instead
    sticks: np.record
    coefficients: np.ndarray  # (K,), scratch: a polynomial
    slopes: np.ndarray  # (K,), scratch: its derivative


class Difference(NamedTuple):
    """Scratch of an event: the change that it makes in the blocks within its reach."""

    rows: np.ndarray  # (K, COLUMNS), time derivatives at the event of the change of slip
    centre: np.ndarray  # (K + 2,), those of the block of the event
    values: np.ndarray  # (COLUMNS,)


class Changed(NamedTuple):
    """Blocks changed by each event of a step; ``count.n`` events."""

    first: np.ndarray
    last: np.ndarray  # the one after the last
    stuck: np.ndarray  # the block that stuck, -1: a release
    count: np.record  # type: ignore[assignment]
    kinks: np.record
    work_kinks: np.record  # those of the work against friction with a bend


class Scratch(NamedTuple):
    """Everything that lasts for one step."""

    moved: Segments  # all blocks that slid at any time of the step
    forecast: Forecast
    difference: Difference
    changed: Changed


class History(NamedTuple):
    """Releases and sticks until now, and counters."""

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
    """The step, and the end of a call."""

    order: int
    largest_step: float
    end_time: float
    largest_force: float  # largest |tau|
    steps: int  # most steps of one call


def make_motion(rows: int, size: int) -> Motion:
    """Blocks at rest. All rows lie in one piece of memory, equally spaced: see `lattice.PAGE`."""
    memory = np.zeros((rows + len(Motion._fields) - 1, size))
    return Motion(memory[:rows], *memory[rows:])


def make_segments(size: int) -> Segments:
    """No segments, on a lattice of ``size`` blocks."""
    return Segments(np.zeros(size, dtype=np.int64), record(COUNT))


def make_scratch(size: int, order: int) -> Scratch:
    """Scratch arrays of a lattice of ``size`` blocks, without events."""
    release, stick_time = np.full(size, np.inf), np.zeros(2 * size)
    stick_block, bends = np.zeros(2 * size, dtype=np.int64), np.zeros(2 * size, dtype=bool)
    polynomials, values = np.zeros((2, order + 2)), np.zeros(COLUMNS)
    forecast = Forecast(release, stick_block, stick_time, bends, record(COUNT), *polynomials)
    difference = Difference(np.zeros((order + 2, COLUMNS)), np.zeros(order + 4), values)
    first, last, stuck = np.zeros((3, MOST_EVENTS), dtype=np.int64)
    changed = Changed(first, last, stuck, record(COUNT), record(KINKS), record(KINKS))
    return Scratch(make_segments(size), forecast, difference, changed)
