"""Arrays, constants and counters that the kernels share, in named groups.

Each group is a NamedTuple, which the kernels read by field name. In the shapes of arrays, K is the
number of time derivatives of slip, from derivative 0 to derivative order + 1. N is the number of
blocks of the lattice, with one ghost block at each end. Lengths are in units of H, times in units
of H divided by the wave speed, and stresses in units of the stress drop.
"""

from typing import NamedTuple

import numpy as np

from ..model.friction_laws.law import LawKink

# Rows of `Motion.derivatives`: time derivatives of slip.
SLIP = 0
VELOCITY = 1
ACCELERATION = 2
# At the end of a step, row 2 holds the change of slip in the step instead.
SLIP_INCREMENT = 2

# An event reaches this number of blocks on either side at order 8, the highest: one block for each
# derivative from the third on.
EVENT_REACH = 7
# The change that an event makes is stored in columns: its reach on either side of the block of the
# event, and one block at rest at each end.
CENTRE_COLUMN = EVENT_REACH + 1
COLUMN_COUNT = 2 * CENTRE_COLUMN + 1
# After this number of events, a step ends early at the next event.
MAX_EVENTS_PER_STEP = 64
# The events of one step need this number of blocks beyond the outermost sliding block.
EDGE_BLOCKS = COLUMN_COUNT + MAX_EVENTS_PER_STEP

# Reasons why a kernel stopped, which it returns.
END_REACHED = 0
STEPS_DONE = 1  # the largest number of steps of one call
LATTICE_TOO_SHORT = 2
BLOWN_UP = 3
ALL_STUCK = 4

# The types below are those of records, whose fields kernels and Python read as attributes. Numba
# recognises a dtype by its address. There is therefore one object for each type of record: a copy
# would be looked up in each call.

# Totals of a run. The losses of the last step still lack a part that depends on the dissipation at
# its end. Until this part is added, pending_step is the length of that step; afterwards it is 0.
_FLOATS = (
    "time first_stick_time pending_step viscous_loss stick_loss friction_loss min_velocity"
    " min_stuck_stress"
)
_COUNTS = (
    "steps block_updates event_updates samples_taken releases re_releases sticks first_stuck_block"
)
_TALLY_TYPES = dict.fromkeys(_FLOATS.split(), "f8") | dict.fromkeys(_COUNTS.split(), "i8")
TALLY_DTYPE = np.dtype((np.record, [*_TALLY_TYPES.items()]))
# The number of entries of a list that is kept in an array.
COUNT_DTYPE = np.dtype((np.record, [("n", np.int64)]))
# Changes of the slope (time derivative) of a dissipation. An event at time s of a step changes it
# by k. The three moments are the sums of k, k s and k s^2 over the events of the step.
_MOMENTS = ("moment_0", "moment_1", "moment_2")
SLOPE_CHANGES_DTYPE = np.dtype((np.record, [(name, np.float64) for name in _MOMENTS]))


def new_record(dtype: np.dtype) -> np.record:
    """Return one record of a type, with all fields set to 0."""
    return np.zeros(1, dtype=dtype)[0]


class Medium(NamedTuple):
    """Constants of the equation of motion and of the release rule."""

    dx: float
    inverse_dx: float  # 1/dx
    inverse_dx2: float  # 1/dx^2
    leaf_stiffness: float  # Gamma gamma
    beta: float
    damping: float  # beta/dx^2
    alpha: float  # friction per unit slip velocity, if friction is linear in it
    law_number: int  # position of any other law of friction in the list of laws, 0 if there is none
    law_parameter_1: float  # of this other law
    law_parameter_2: float
    law_kink: LawKink | None  # piecewise linear friction, which the Taylor step solves
    is_mirrored: bool  # block 1 lies at x = 0, and block 0 is the mirror image of block 2
    damping_counts_for_release: bool  # the damping force is part of the stress compared with 1


class Motion(NamedTuple):
    """State of the blocks. All values of a block at rest without slip are 0."""

    # (K, N), time derivatives of slip at the start of the step; row k is derivative k
    derivatives: np.ndarray
    event_slip: np.ndarray  # (N,), slip that the events of this step add, until its end
    end_velocity: np.ndarray  # (N,), slip velocity at the end of the step
    strain: np.ndarray  # (N,), (u_{i+1} - u_i)/dx
    tau: np.ndarray  # (N,), pre-stress
    # The next three are used only by laws of friction that are not linear in slip velocity.
    weakening_slope: np.ndarray  # (N,), decrease of friction per unit slip or slip rate
    law_factor: np.ndarray  # (N,), 0 where the rupture is nucleated without friction, 1 elsewhere
    slip_at_release: np.ndarray  # (N,), slip at the last release


class Segments(NamedTuple):
    """Contiguous stretches [start, end) of sliding blocks, in order. Their number is count.n."""

    edges: np.ndarray  # (N,), start, end, start, end, ...
    count: np.record  # type: ignore[assignment]


class Event(NamedTuple):
    """One event of a block: its release, its stick, or its friction at the kink of the law."""

    block: int
    time: float  # since the step began
    is_stick: bool
    is_law_kink: bool


class EventEffect(NamedTuple):
    """Changes that an event made, for the counters and for the energy balance."""

    is_finite: bool  # velocities are finite
    first: int  # first block that changed
    last: int  # block after the last one that changed
    velocity_before: float  # velocity of a block that sticks, which should be 0
    lowest_stress: float  # of the stuck blocks next to the changed ones
    # Changes of the slopes of two dissipations, for velocities v and accelerations a. The first is
    # the sum of (v_{i+1} - v_i) times the change of a_{i+1} - a_i. The second is friction times the
    # change of a.
    loss_slope_change: float
    work_slope_change: float


class EventPrediction(NamedTuple):
    """Events predicted within the step: releases of stuck blocks, and events of sliding blocks."""

    # (N,), release time of each stuck neighbour of a segment; inf if it is not released in the
    # step, or if it is a mirror image
    release_time: np.ndarray
    # Sticks and kinks of the law: the first event_count.n entries of the next three arrays.
    event_block: np.ndarray  # (2 N,)
    event_time: np.ndarray  # (2 N,)
    is_law_kink: np.ndarray  # (2 N,), False for a stick
    event_count: np.record
    coefficients: np.ndarray  # (K,), scratch: a polynomial
    slopes: np.ndarray  # (K,), scratch: its derivative


class Difference(NamedTuple):
    """Scratch of one event: the change that it makes in the blocks within its reach."""

    # (K, COLUMN_COUNT), time derivatives of the change of slip, at the time of the event
    derivatives: np.ndarray
    block_change: np.ndarray  # (K + 2,), the same for the block of the event alone
    values: np.ndarray  # (COLUMN_COUNT,), one time derivative of the change, at another time


class StepEvents(NamedTuple):
    """Events of the present step, and the blocks that each changed. Their number is count.n."""

    first: np.ndarray  # first block that changed
    last: np.ndarray  # block after the last one that changed
    stuck_block: np.ndarray  # block that stuck, -1 if the event is no stick
    count: np.record  # type: ignore[assignment]
    loss_slope_changes: np.record  # of the viscous dissipation
    work_slope_changes: np.record  # of the power of piecewise linear friction


class Scratch(NamedTuple):
    """Everything that lasts for one step."""

    moved: Segments  # all blocks that slid at any time of the step
    prediction: EventPrediction
    difference: Difference
    step_events: StepEvents


class History(NamedTuple):
    """Releases and sticks until now, and counters."""

    release_time: np.ndarray  # (N,), first release; NaN if never released
    stick_time: np.ndarray  # (N,), last stick; NaN if there is none, or if released again
    tally: np.record


class Recorder(NamedTuple):
    """Samples of slip and slip velocity, at T times and P blocks."""

    times: np.ndarray  # (T,)
    blocks: np.ndarray  # (P,), -1 outside the lattice, where everything is at rest
    slip: np.ndarray  # (T, P)
    velocity: np.ndarray  # (T, P)


class Limits(NamedTuple):
    """Size of the step, and the conditions that end a call."""

    order: int
    largest_step: float
    end_time: float
    largest_force: float  # bound on the force that drives a block
    max_steps: int  # of one call


def make_motion(rows: int, size: int) -> Motion:
    """Return a lattice of ``size`` blocks at rest, with ``rows`` time derivatives of slip.

    All arrays are rows of one piece of memory, at equal distances. `lattice.PAGE_BLOCKS` explains
    why their distance matters.
    """
    other_arrays = len(Motion._fields) - 1
    memory = np.zeros((rows + other_arrays, size))
    return Motion(memory[:rows], *memory[rows:])


def make_segments(size: int) -> Segments:
    """Return an empty list of segments for a lattice of ``size`` blocks."""
    return Segments(np.zeros(size, dtype=np.int64), new_record(COUNT_DTYPE))


def make_scratch(size: int, order: int) -> Scratch:
    """Return scratch arrays without events, for ``size`` blocks and steps of an order.

    Slip has the time derivatives 0 to order + 1. A released block needs two more for a moment.
    """
    # Two events can be predicted for each block: a stick and a kink of the law of friction.
    prediction = EventPrediction(
        release_time=np.full(size, np.inf),
        event_block=np.zeros(2 * size, dtype=np.int64),
        event_time=np.zeros(2 * size),
        is_law_kink=np.zeros(2 * size, dtype=bool),
        event_count=new_record(COUNT_DTYPE),
        coefficients=np.zeros(order + 2),
        slopes=np.zeros(order + 2),
    )
    difference = Difference(
        derivatives=np.zeros((order + 2, COLUMN_COUNT)),
        block_change=np.zeros(order + 4),
        values=np.zeros(COLUMN_COUNT),
    )
    first, last, stuck_block = np.zeros((3, MAX_EVENTS_PER_STEP), dtype=np.int64)
    step_events = StepEvents(
        first=first,
        last=last,
        stuck_block=stuck_block,
        count=new_record(COUNT_DTYPE),
        loss_slope_changes=new_record(SLOPE_CHANGES_DTYPE),
        work_slope_changes=new_record(SLOPE_CHANGES_DTYPE),
    )
    return Scratch(make_segments(size), prediction, difference, step_events)
