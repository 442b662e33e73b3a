"""The elastic layer in the plane, without the average over its height that the paper takes.

Plane strain, 0 <= y <= 1. Lengths are in units of the thickness H, times in units of H divided by
the compressional wave speed, and stresses in units of (mu_s - mu_k) sigma_n. All fields are changes
from the state of rest under the pre-stress. Velocities v and stresses s obey

    dv_x/dt = ds_xx/dx + ds_xy/dy        ds_xx/dt = dv_x/dx + (1 - gamma) dv_y/dy
    dv_y/dt = ds_xy/dx + ds_yy/dy        ds_yy/dt = (1 - gamma) dv_x/dx + dv_y/dy
                                         ds_xy/dt = (gamma/2) (dv_x/dy + dv_y/dx)

with gamma = 2G/(lambda + 2G). They are solved on a grid that is staggered in space and time:

    row j + 1    v_x         s_xx, s_yy
    between      s_xy        v_y
    row j        v_x         s_xx, s_yy

Here h is the side of a square cell. The left column of the scheme is at x = i h, and the right one
half a cell further. Rows lie at y = j h from the bottom to the top, and the two outer rows have
half the height of a cell. Velocities are known half a time step before and after the stresses. The
scheme conserves a discrete energy, so the energy that friction dissipates is exact to rounding.

The kernels get the constants of the layer (``elastic``), its velocities and stresses (``fields``,
with rows j and columns i), and the state of the nodes at its bottom (``fault``).
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from ..model.checks import check_choice, check_number, check_that
from ..model.prestress import Prestress
from .jit import kernel_entry, kernel_function

# Time step as a fraction of the largest stable one, h / sqrt(2).
COURANT_FRACTION = 0.85
# Largest stable damping beta, divided by the spacing h.
MAX_DAMPING_RATIO = 0.11
# On a grid, small precursors run ahead of the compressional wave. This number of cells is kept for
# them.
PRECURSOR_CELLS = 32
# Number types of the velocities and stresses.
PRECISIONS: dict[str, Any] = {"double": np.float64, "single": np.float32}


@dataclass(frozen=True)
class LayerScene:
    """Rupture of the layer in the plane, with friction that weakens with slip.

    If ``rate`` is 0, the strength falls linearly with the slip since the release. Otherwise it
    relaxes towards 1/(1 + V/rate) at the slip velocity V, over the slip ``weakening``. It then
    recovers while a point slows down. A point that sticks has its full strength again.
    """

    boundary: str  # held at the top: "displacement" (v_x = 0) or "stress" (s_xy = 0)
    gamma: float  # 2G/(lambda + 2G), in (0, 1)
    prestress: Prestress  # shear stress tau(x) at the bottom before the rupture, as in `Scene`
    weakening: float  # slip d_c over which the strength falls (units of U)
    duration: float
    cells: int = 40  # across the thickness
    nucleation: float = 2.0  # friction is 0 at |x| <= nucleation from t = 0 on
    top: str = "held"  # normal displacement is held, or "free": normal stress does not change
    coupling: float = 0.0  # friction coefficient mu, if the strength follows pressure: - mu s_yy
    rate: float = 0.0  # slip velocity at which the strength is halved, 0 if it has no influence
    # Columns farther than this behind the compressional wave from x = 0 are no longer advanced. No
    # wave is faster, so this changes no event at x until the time x + trail.
    trail: float = math.inf
    # Damping: beta times its rate is added to each stress, as to the elastic force in `Scene`.
    beta: float = 0.0
    # "single" takes less than half the time of "double". Times and slips of pulses then differ by
    # some 1e-6, and slip at points that stick and slide many times by up to 1 %. Both differences
    # are much smaller than the error of the grid.
    precision: str = "double"

    def __post_init__(self) -> None:
        check_choice("boundary", self.boundary, ("displacement", "stress"))
        check_number("gamma", self.gamma, above=0.0, below=1.0)
        for name in ("weakening", "duration"):
            check_number(name, getattr(self, name), above=0.0)
        for name in ("nucleation", "coupling", "rate", "beta"):
            check_number(name, getattr(self, name), at_least=0.0)
        check_number("cells", self.cells, integer=True, at_least=4)
        check_that(self.trail > 0.0, "trail", self.trail, "a positive number")
        largest = MAX_DAMPING_RATIO / self.cells
        allowed = f"a number <= {largest:.4g}, above which a grid of {self.cells} cells is unstable"
        check_that(self.beta * self.cells <= MAX_DAMPING_RATIO, "beta", self.beta, allowed)
        allowed = "inf, unless the scene is symmetric"
        check_that(self.symmetric or math.isinf(self.trail), "trail", self.trail, allowed)
        check_choice("top", self.top, ("held", "free"))
        check_choice("precision", self.precision, tuple(PRECISIONS))

    @property
    def slip_scale(self) -> float:
        """Unit U of slip (appendix B), divided by H (mu_s - mu_k) sigma_n/(lambda + 2G)."""
        return 2.0 if self.boundary == "displacement" else 1.0

    @property
    def symmetric(self) -> bool:
        """True if it is enough to solve the half x >= 0."""
        return self.prestress.symmetric and self.coupling == 0.0

    @property
    def number_type(self) -> Any:
        """Number type of the velocities and stresses."""
        return PRECISIONS[self.precision]


@dataclass(frozen=True)
class LayerRun:
    """Slip of the N nodes at the bottom, and the motion of the layer at the end."""

    x: np.ndarray  # (N,) position
    slip: np.ndarray  # (N,) slip at the end, in units of U
    velocity: np.ndarray  # (cells + 1, N) v_x at the end, from the bottom to the top
    release_time: np.ndarray  # (N,) first release, NaN if never released
    stick_time: np.ndarray  # (N,) first stick, NaN if it never sticks
    # Missing energy divided by the work of the pre-stress; NaN with damping, or if columns were no
    # longer advanced.
    energy_residual: float


class Elastic(NamedTuple):
    """Constants of the layer and of its grid. Arrays have one value for each row y = j h."""

    dt_over_h: float  # time step divided by the side of a cell
    shear: float  # gamma/2
    is_mirrored: bool  # node 1 lies on an axis of symmetry
    moving_rows: int  # rows whose v_x is not held
    coupling: float  # mu
    weakening: float  # d_c in units of H (mu_s - mu_k) sigma_n/(lambda + 2G)
    rate: float  # slip velocity at which the strength is halved, in the unit of vx
    damping: float  # beta divided by the time step
    # Weights of the values above and below a row, which are (2, 0) and (0, 2) at the outer rows
    above: np.ndarray
    below: np.ndarray
    direct: np.ndarray  # modulus of s_xx, less on a free row
    lateral: np.ndarray  # 1 - gamma, 0 on a free row
    normal: np.ndarray  # modulus of s_yy, 0 on a free row


class Fields(NamedTuple):
    """Velocities and stresses, with one row for each y and one column for each x.

    Column 0 is a ghost, which is at rest or a mirror image.
    """

    vx: np.ndarray  # (cells + 1, N)
    vy: np.ndarray  # (cells, N)
    sxx: np.ndarray  # (cells + 1, N)
    syy: np.ndarray  # (cells + 1, N)
    sxy: np.ndarray  # (cells, N)


class DampedFields(NamedTuple):
    """Fields of a damped layer. All share the velocities; without damping also the stresses."""

    elastic: Fields  # stresses of the strain
    earlier: Fields  # the same one step before
    total: Fields  # stresses that include damping


class Fault(NamedTuple):
    """State of the nodes at the bottom, where slip has the unit of `Elastic.weakening`.

    The arrays have the shape (N,) unless another one is stated.
    """

    tau: np.ndarray  # pre-stress
    nucleus: np.ndarray  # True where friction is 0
    sliding: np.ndarray
    slip: np.ndarray
    slip_at_release: np.ndarray
    strength: np.ndarray  # of sliding nodes, if it depends on slip velocity
    release_time: np.ndarray
    stick_time: np.ndarray
    excess: np.ndarray  # shear stress minus strength at the last step, of nodes at rest
    # (2,), both divided by h: work of the pre-stress, and work of the pre-stress minus friction
    work: np.ndarray


class Columns(NamedTuple):
    """The columns of the grid that are advanced."""

    centre: int  # node at x = 0
    nucleation: int  # number of columns without friction on each side of it
    trail: int  # number of columns behind the compressional wave from x = 0 that are advanced


@kernel_function()
def update_stresses(elastic, fields, first, last):
    """Advance the stresses of columns first..last-1 by one step, from the velocities.

        ds_xx/dt = direct dv_x/dx + lateral dv_y/dy     ds_xy/dt = shear (dv_x/dy + dv_y/dx)
        ds_yy/dt = lateral dv_x/dx + normal dv_y/dy

    The factors are elastic moduli, which can differ from row to row. Derivatives are replaced by
    differences between neighbours, divided by their distance h.
    """
    vx, vy, sxx, syy, sxy = fields
    cells, dt_over_h = vy.shape[0], elastic.dt_over_h
    # s_xx and s_yy, which lie on the rows.
    for j in range(cells + 1):
        direct, lateral = dt_over_h * elastic.direct[j], dt_over_h * elastic.lateral[j]
        normal = dt_over_h * elastic.normal[j]
        # v_y half a cell above and below the row, with the weights 1. An outer row has only one of
        # the two, with the weight 2, because the row has half the height of a cell.
        weight_above, weight_below = elastic.above[j], elastic.below[j]
        above, below = vy[min(j, cells - 1), first:last], vy[max(j - 1, 0), first:last]
        left, right = vx[j, first:last], vx[j, first + 1 : last + 1]
        s_xx, s_yy = sxx[j, first:last], syy[j, first:last]
        for i in range(s_xx.shape[0]):
            dvx_dx = right[i] - left[i]
            dvy_dy = weight_above * above[i] - weight_below * below[i]
            s_xx[i] += direct * dvx_dx + lateral * dvy_dy
            s_yy[i] += lateral * dvx_dx + normal * dvy_dy
        # Column 0 is a mirror image, in which s_xx has the opposite sign.
        if elastic.is_mirrored:
            sxx[j, 0] = -sxx[j, 1]
    # s_xy, which lies half a cell above row j.
    factor = dt_over_h * elastic.shear
    for j in range(cells):
        low, high = vx[j, first:last], vx[j + 1, first:last]
        left, right = vy[j, first - 1 : last - 1], vy[j, first:last]
        s_xy = sxy[j, first:last]
        for i in range(s_xy.shape[0]):
            s_xy[i] += factor * (high[i] - low[i] + right[i] - left[i])


@kernel_function()
def update_velocities(elastic, fields, first, last):
    """Advance the velocities of columns first..last-1 by one step, except v_x at the bottom.

        dv_x/dt = ds_xx/dx + ds_xy/dy     dv_y/dt = ds_xy/dx + ds_yy/dy

    Derivatives are replaced by differences between neighbours, divided by their distance h. Rows
    from ``moving_rows`` on have a v_x that is held.
    """
    vx, vy, sxx, syy, sxy = fields
    cells, dt_over_h = vy.shape[0], elastic.dt_over_h
    # v_y, which lies half a cell above row j.
    for j in range(cells):
        left, right = sxy[j, first:last], sxy[j, first + 1 : last + 1]
        low, high = syy[j, first:last], syy[j + 1, first:last]
        v = vy[j, first:last]
        for i in range(v.shape[0]):
            v[i] += dt_over_h * (right[i] - left[i] + high[i] - low[i])
        # Column 0 is a mirror image, in which v_y has the opposite sign.
        if elastic.is_mirrored:
            vy[j, 0] = -vy[j, 1]
    # v_x on the rows above the bottom. The weights of the s_xy above and below a row are 1. Only a
    # top row that moves has no s_xy above it (weight 0), and that below it counts twice, since the
    # row has half the height of a cell.
    for j in range(1, elastic.moving_rows):
        weight_above, weight_below = elastic.above[j], elastic.below[j]
        left, right = sxx[j, first - 1 : last - 1], sxx[j, first:last]
        low, high = sxy[j - 1, first:last], sxy[min(j, cells - 1), first:last]
        v = vx[j, first:last]
        for i in range(v.shape[0]):
            dsxx_dx = right[i] - left[i]
            v[i] += dt_over_h * (dsxx_dx + weight_above * high[i] - weight_below * low[i])


@kernel_function()
def compute_strength(elastic, fields, fault, i):
    """Return the strength of node i (largest friction), from its motion and its normal stress.

    Without normal stress, it is 1 at rest, and falls linearly with the slip since the release, to 0
    at the slip ``weakening``. If ``rate`` is not 0, `advance_node` lets the strength depend on slip
    velocity instead, and keeps it in ``fault.strength``. Pressure, the negative normal stress,
    strengthens the node by ``coupling`` times its value. The nucleus, where the rupture starts, has
    no friction.
    """
    if fault.nucleus[i]:
        return 0.0
    # Decrease of the strength since the release of the node.
    weakening = 0.0
    if fault.sliding[i]:
        if elastic.rate > 0.0:
            weakening = 1.0 - fault.strength[i]
        else:
            weakening = (fault.slip[i] - fault.slip_at_release[i]) / elastic.weakening
    # The normal stress is known half a cell to the left and to the right of the node.
    normal_stress = 0.5 * (fields.syy[0, i - 1] + fields.syy[0, i])
    return max(0.0, 1.0 - weakening) - elastic.coupling * normal_stress


@kernel_function()
def advance_node(elastic, fields, fault, i, dt, time):
    """Advance v_x and the slip of node i at the bottom by one step, and add the work done.

    A node at rest is released when its load, the shear stress, reaches its strength. It sticks when
    its velocity falls to 0. The times of its first release and first stick are recorded.

    time : time of the stresses, in the middle of the step of the velocities
    """
    # The bottom row has half the height of a cell, so that the difference of s_xx counts half.
    load = fields.sxy[0, i] + 0.5 * (fields.sxx[0, i] - fields.sxx[0, i - 1]) + fault.tau[i]
    strength = compute_strength(elastic, fields, fault, i)
    if not fault.sliding[i]:
        excess, excess_before = load - strength, fault.excess[i]
        fault.excess[i] = excess
        if excess < 0.0:
            return
        fault.sliding[i] = True
        fault.slip_at_release[i] = fault.slip[i]
        fault.strength[i] = 1.0
        if np.isnan(fault.release_time[i]):
            # The load is interpolated linearly in time between two steps.
            delay = excess / (excess - excess_before) if excess_before < 0.0 else 0.0
            fault.release_time[i] = time - delay * dt
    # The node slides. A force changes the velocity of a whole cell by dt/h times the force. Half a
    # cell has half the mass, so that its velocity changes twice as much.
    velocity_before = fields.vx[0, i]
    velocity = velocity_before + 2.0 * elastic.dt_over_h * (load - strength)
    if velocity <= 0.0:
        # The node sticks. This is recorded unless the node has not moved, because it was released
        # at this step without excess load.
        if velocity_before > 0.0 and np.isnan(fault.stick_time[i]):
            # The velocity is interpolated linearly from half a step before to half a step after.
            fraction = velocity_before / (velocity_before - velocity)
            fault.stick_time[i] = time + (fraction - 0.5) * dt
        velocity = 0.0
        fault.sliding[i] = False
    fields.vx[0, i] = velocity
    fault.slip[i] += dt * velocity
    if elastic.rate > 0.0:
        # The strength relaxes towards its steady value over the slip ``weakening``.
        steady = 1.0 / (1.0 + velocity / elastic.rate)
        remaining = np.exp(-dt * velocity / elastic.weakening)
        fault.strength[i] = steady + (fault.strength[i] - steady) * remaining
    # Work is force times the distance moved at the mean velocity. A node on the axis of symmetry
    # counts half.
    distance = 0.5 * dt * (velocity_before + velocity)
    if elastic.is_mirrored and i == 1:
        distance *= 0.5
    # The friction that acted follows from the change of velocity, also when the node sticks. The
    # two numbers in ``work`` are the work of the pre-stress, and its work minus that of friction.
    # The first one is only a scale for the energy error, and counts negative work as positive.
    friction = load - (velocity - velocity_before) / (2.0 * elastic.dt_over_h)
    fault.work[0] += abs(fault.tau[i]) * distance
    fault.work[1] += (fault.tau[i] - friction) * distance


@kernel_function()
def add_damping(elastic, earlier, fields, total, first, last):
    """Set the total stresses, those of ``fields`` plus beta times their rates of change.

    The constant ``elastic.damping`` is beta divided by the time step. The columns on either side of
    first..last-1 are included, because the velocities depend on them, too.

    earlier : stresses one step before, which are replaced by those of ``fields``
    """
    stresses = (
        (earlier.sxx, fields.sxx, total.sxx),
        (earlier.syy, fields.syy, total.syy),
        (earlier.sxy, fields.sxy, total.sxy),
    )
    for before, now, with_damping in stresses:
        for j in range(now.shape[0]):
            for i in range(first - 1, last + 1):
                with_damping[j, i] = now[j, i] + elastic.damping * (now[j, i] - before[j, i])
                before[j, i] = now[j, i]


@kernel_entry
def advance_layer(elastic, damped_fields, fault, dt, steps, columns):
    """Advance from step ``steps[0]`` to step ``steps[1]``, in the columns that waves can reach.

    damped_fields : `DampedFields`: the fields with elastic stresses, with the elastic stresses of
        the step before, and with total stresses (elastic stresses plus damping). The velocities are
        the same arrays in all three; without damping, the stresses are the same arrays, too
    columns : `Columns`, which limit the range that is advanced
    """
    fields, earlier, total = damped_fields
    centre = columns.centre
    for number in range(steps[0], steps[1]):
        # Number of columns that a compressional wave of speed 1 has crossed since t = 0.
        crossed = int(number * elastic.dt_over_h)
        reach = columns.nucleation + crossed + PRECURSOR_CELLS
        first, last = max(1, centre - reach), min(fault.tau.shape[0] - 1, centre + reach)
        # Columns far behind the wave are left out.
        first = max(first, centre + crossed - columns.trail)
        update_stresses(elastic, fields, first, last)
        if elastic.damping > 0.0:
            add_damping(elastic, earlier, fields, total, first, last)
        # Without damping, the total stresses are the elastic ones just updated.
        update_velocities(elastic, total, first, last)
        for i in range(first, last):
            advance_node(elastic, total, fault, i, dt, number * dt)


def simulate_layer(scene: LayerScene) -> LayerRun:
    """Simulate a rupture on a grid that is so long that no wave reaches its ends.

    The slip and v_x are returned in units of ``slip_scale``, without the two outermost columns,
    which are never advanced.
    """
    # The time step, and the grid along x.
    h = 1.0 / scene.cells
    dt = COURANT_FRACTION * h / np.sqrt(2.0)
    steps = int(np.ceil(scene.duration / dt))
    nucleation_columns = int(scene.nucleation / h + 0.5)
    # No wave is faster than 1, so that during the run waves cross at most this many columns. Small
    # waves of the grid run ahead, for which some columns (PRECURSOR_CELLS) and a margin are added.
    crossed_columns = int(steps * dt / h)
    columns_on_right = nucleation_columns + crossed_columns + 2 * PRECURSOR_CELLS
    # A symmetric layer has one column on the left, the mirror image of the first on the right.
    centre = 1 if scene.symmetric else columns_on_right
    x = (np.arange(centre + columns_on_right) - centre) * h
    elastic, fields, fault = layer_at_rest(scene, x, dt / h)
    # Columns farther behind the wave than the trail are no longer advanced. If the trail is
    # infinite, all columns are advanced, including those at x < 0.
    trail_columns = int(min(scene.trail / h + PRECURSOR_CELLS, x.size))
    columns = Columns(centre, nucleation_columns, trail_columns)
    # The first of its three groups of fields is ``fields``, which `advance_layer` changes in place.
    damped = damped_fields(elastic, fields)
    advance_layer(elastic, damped, fault, dt, (0, steps - 1), columns)
    # The energy is computed one step before the end, at the time of the velocities that are copied
    # here. This needs the stresses half a step before, which are copied as well, and those half a
    # step after, which the last step computes.
    earlier = Fields._make(array.copy() for array in fields)
    # The net work is the work of the pre-stress minus that of friction.
    work_of_prestress, net_work = fault.work.tolist()
    advance_layer(elastic, damped, fault, dt, (steps - 1, steps), columns)
    energy = stored_energy(elastic, earlier, fields) * h
    # The energy balance holds only without damping, and if all columns are advanced.
    residual = math.nan
    if scene.beta == 0.0 and math.isinf(scene.trail):
        missing = abs(energy - net_work)
        # Without work nothing has moved.
        residual = missing / work_of_prestress if work_of_prestress else 0.0
    return LayerRun(
        x=x[1:-1],
        slip=fault.slip[1:-1] / scene.slip_scale,
        velocity=fields.vx[:, 1:-1] / scene.slip_scale,
        release_time=fault.release_time[1:-1],
        stick_time=fault.stick_time[1:-1],
        energy_residual=residual,
    )


def damped_fields(elastic: Elastic, fields: Fields) -> DampedFields:
    """Return the fields of a layer at the start, three times if it is damped.

    Damping is computed from the change of the elastic stresses in a step. A damped layer therefore
    needs its elastic stresses, those of one step before, and total stresses, which include damping.
    All three share the velocities.
    """
    if elastic.damping == 0.0:
        return DampedFields(elastic=fields, earlier=fields, total=fields)
    return DampedFields(
        elastic=fields, earlier=with_copied_stresses(fields), total=with_copied_stresses(fields)
    )


def with_copied_stresses(fields: Fields) -> Fields:
    """Return fields that share the given velocities, and have copies of the given stresses."""
    return fields._replace(sxx=fields.sxx.copy(), syy=fields.syy.copy(), sxy=fields.sxy.copy())


class LayerState(NamedTuple):
    """Everything that the kernel needs of a layer."""

    elastic: Elastic
    fields: Fields
    fault: Fault


def layer_at_rest(scene: LayerScene, x: np.ndarray, dt_over_h: float) -> LayerState:
    """Return the layer of a scene before t = 0.

    x : positions of the nodes
    dt_over_h : time step divided by the side of a cell
    """
    return LayerState(
        elastic=_elastic_constants(scene, dt_over_h),
        fields=_fields_at_rest(scene, x.size),
        fault=_fault_at_rest(scene, x),
    )


def _elastic_constants(scene: LayerScene, dt_over_h: float) -> Elastic:
    """Return the constants of the layer and of its grid of square cells.

    dt_over_h : time step divided by the side of a cell
    """
    # Modulus of s_yy: 0 on a free top row, where the normal stress stays 0, and 1 on all others.
    normal = np.ones(scene.cells + 1)
    normal[-1] = 1.0 if scene.top == "held" else 0.0
    # Weights of the values of v_y and s_xy half a cell above and below each row. The bottom row has
    # only a value above it, and the top row only one below it. This value counts twice, since these
    # rows have half the height.
    above, below = np.ones(scene.cells + 1), np.ones(scene.cells + 1)
    above[0], above[-1] = 2.0, 0.0
    below[0], below[-1] = 0.0, 2.0
    # Modulus of a normal stress for strain in the other direction. The modulus of s_xx for strain
    # in its own direction, ``direct``, is 1, but less on a free row, where s_yy stays 0.
    lateral = 1.0 - scene.gamma
    # The top row moves unless it is held.
    moving_rows = scene.cells + 1 if scene.boundary == "stress" else scene.cells
    time_step = dt_over_h / scene.cells
    # With these types, the kernel computes in the precision of the fields.
    number_type = scene.number_type
    return Elastic(
        dt_over_h=number_type(dt_over_h),
        shear=number_type(0.5 * scene.gamma),
        is_mirrored=scene.symmetric,
        moving_rows=moving_rows,
        coupling=scene.coupling,
        # The scene has slip in units of ``slip_scale``, and the layer in units of 1.
        weakening=scene.weakening * scene.slip_scale,
        rate=scene.rate * scene.slip_scale,
        damping=number_type(scene.beta / time_step),
        above=above.astype(number_type),
        below=below.astype(number_type),
        direct=np.where(normal, 1.0, 1.0 - lateral**2).astype(number_type),
        lateral=(lateral * normal).astype(number_type),
        normal=normal.astype(number_type),
    )


def _fields_at_rest(scene: LayerScene, size: int) -> Fields:
    """Return velocities and stresses of 0, on rows of ``size`` nodes."""
    on_rows, between_rows = (scene.cells + 1, size), (scene.cells, size)
    return Fields(
        vx=np.zeros(on_rows, scene.number_type),
        vy=np.zeros(between_rows, scene.number_type),
        sxx=np.zeros(on_rows, scene.number_type),
        syy=np.zeros(on_rows, scene.number_type),
        sxy=np.zeros(between_rows, scene.number_type),
    )


def _fault_at_rest(scene: LayerScene, x: np.ndarray) -> Fault:
    """Return the state of the bottom before t = 0, at nodes of positions x.

    All nodes are at rest. Friction is 0 at the nodes of the nucleus, where the rupture starts,
    whatever their value of ``strength``.
    """
    tau = scene.prestress(x)
    # A quarter of a cell is added, so that rounding does not decide about the outermost node.
    nucleus = np.abs(x) <= scene.nucleation + 0.25 / scene.cells
    return Fault(
        tau=tau,
        nucleus=nucleus,
        sliding=np.zeros(x.size, dtype=bool),
        slip=np.zeros(x.size),
        slip_at_release=np.zeros(x.size),
        strength=np.ones(x.size),
        release_time=np.full(x.size, np.nan),
        stick_time=np.full(x.size, np.nan),
        # Shear stress minus the strength that acts, which is 0 in the nucleus and 1 elsewhere.
        excess=tau - np.where(nucleus, 0.0, 1.0),
        # Work of the pre-stress, and its work minus that of friction.
        work=np.zeros(2),
    )


def stored_energy(elastic: Elastic, earlier: Fields, later: Fields) -> float:
    """Return the energy of the layer divided by h^2, at the time of the velocities.

    The elastic energy is a product of the stresses half a step earlier and half a step later.

    earlier : fields whose velocities are those of this time, and whose stresses are half a step
        earlier
    later : fields whose stresses are half a step later
    """
    # The fraction of a cell that belongs to each row, to each column half a cell right of the
    # nodes, and to each column of nodes. Column 0 is a ghost.
    rows = np.ones((earlier.vx.shape[0], 1))
    rows[[0, -1]] = 0.5
    columns = np.ones(earlier.vx.shape[1])
    columns[0] = 0.0
    nodes = columns.copy()
    nodes[1] = 0.5 if elastic.is_mirrored else 1.0
    kinetic = 0.5 * (np.sum(rows * nodes * earlier.vx**2) + np.sum(columns * earlier.vy**2))
    # The strain energy of normal stresses in plane strain, and that of shear stress. The square of
    # a stress is its earlier value times its later value. The modulus for strain in the other
    # direction, ``lateral``, is 1 - gamma; the value 0 of a free top row is not used, since s_yy
    # is 0 there.
    lateral = elastic.lateral.max()
    equal_products = earlier.sxx * later.sxx + earlier.syy * later.syy
    mixed_products = earlier.sxx * later.syy + earlier.syy * later.sxx
    normal = (equal_products - lateral * mixed_products) / (1.0 - lateral**2)
    shear = earlier.sxy * later.sxy / elastic.shear
    return float(kinetic + 0.5 * (np.sum(rows * columns * normal) + np.sum(nodes * shear)))
