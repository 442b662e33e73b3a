"""The elastic layer in the plane, without the average over its height that the paper takes.

Plane strain, 0 <= y <= 1: lengths in units of the thickness H, times in H over the compressional
wave speed, stresses in (mu_s - mu_k) sigma_n. All fields are changes from the state of rest under
the pre-stress. Velocities v and stresses s obey

    dv_x/dt = ds_xx/dx + ds_xy/dy        ds_xx/dt = dv_x/dx + (1 - gamma) dv_y/dy
    dv_y/dt = ds_xy/dx + ds_yy/dy        ds_yy/dt = (1 - gamma) dv_x/dx + dv_y/dy
                                         ds_xy/dt = (gamma/2) (dv_x/dy + dv_y/dx)

with gamma = 2G/(lambda + 2G). On the staggered grid v_x, s_xx and s_yy stand on rows y = j h from
boundary to boundary, v_y and s_xy between two rows; s_xx, s_yy and v_y lie half a cell to the right
of v_x and s_xy; velocities stand at half steps of time. The two outer rows have half the height of
a cell. The scheme conserves a discrete energy, so that friction loses what it should, to rounding.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ..model.checks import check_choice, check_number, check_that
from ..model.prestress import Prestress
from .jit import entry, inner

# Fraction of the largest stable time step, h / sqrt(2).
COURANT = 0.85
# Only precursors of the grid outrun the compressional wave: cells kept for them.
MARGIN = 32


@dataclass(frozen=True)
class LayerScene:
    """Rupture of the layer in the plane, with friction that weakens linearly with slip."""

    boundary: str  # held at the top: "displacement" (v_x = 0) or "stress" (s_xy = 0)
    gamma: float  # 2G/(lambda + 2G), in (0, 1)
    prestress: Prestress  # shear stress tau(x) at the bottom before the rupture, as in `Scene`
    weakening: float  # slip d_c over which the strength falls from 1 to 0 (units of U)
    duration: float
    cells: int = 40  # over the thickness
    nucleation: float = 2.0  # friction is 0 for |x| <= this from t = 0 on
    top: str = "held"  # normal displacement, or "free": no change of normal stress
    coupling: float = 0.0  # friction coefficient mu of a strength - mu s_yy that follows pressure
    # Columns farther than this behind the compressional wave from x = 0 are no longer advanced.
    # That alters no event at x until the time x + trail, since no wave is faster.
    trail: float = math.inf

    def __post_init__(self) -> None:
        check_choice("boundary", self.boundary, ("displacement", "stress"))
        check_number("gamma", self.gamma, above=0.0, below=1.0)
        for name in ("weakening", "duration"):
            check_number(name, getattr(self, name), above=0.0)
        for name in ("nucleation", "coupling"):
            check_number(name, getattr(self, name), at_least=0.0)
        check_number("cells", self.cells, at_least=4)
        check_that(self.trail > 0.0, "trail", self.trail, "a positive number")
        allowed = "a symmetric scene, if the trail is finite"
        check_that(self.symmetric or math.isinf(self.trail), "trail", self.trail, allowed)
        check_choice("top", self.top, ("held", "free"))

    @property
    def slip_scale(self) -> float:
        """U over H (mu_s - mu_k) sigma_n/(lambda + 2G), by appendix B of the paper."""
        return 2.0 if self.boundary == "displacement" else 1.0

    @property
    def symmetric(self) -> bool:
        """True where the half x >= 0 is enough."""
        return self.prestress.symmetric and self.coupling == 0.0


@dataclass(frozen=True)
class LayerRun:
    """Slip of the N nodes at the bottom, and the motion of the layer at the end."""

    x: np.ndarray  # (N,) position
    slip: np.ndarray  # (N,) slip at the end, in units of U
    velocity: np.ndarray  # (cells + 1, N) v_x at the end, from the bottom to the top
    release_time: np.ndarray  # (N,) first release, NaN where never
    stick_time: np.ndarray  # (N,) first stick, NaN where never
    # Unbalanced energy divided by the work of the pre-stress; NaN if columns were left behind.
    energy_residual: float


class Elastic(NamedTuple):
    """Constants of the layer and of its grid; arrays have one number a row y = j h."""

    ratio: float  # dt/h
    shear: float  # gamma/2
    mirror: bool  # node 1 lies on an axis of symmetry
    moving_rows: int  # rows whose v_x is not held
    coupling: float  # mu
    weakening: float  # d_c in units of H (mu_s - mu_k) sigma_n/(lambda + 2G)
    above: np.ndarray  # weights of what stands above a row, and below it: an outer row has one side
    below: np.ndarray
    direct: np.ndarray  # modulus of s_xx, less on a free row
    lateral: np.ndarray  # 1 - gamma, 0 on a free row
    normal: np.ndarray  # modulus of s_yy, 0 on a free row


class Fields(NamedTuple):
    """Velocities and stresses; column 0 is a ghost, which is at rest or a mirror image."""

    vx: np.ndarray  # (cells + 1, N)
    vy: np.ndarray  # (cells, N)
    sxx: np.ndarray  # (cells + 1, N)
    syy: np.ndarray  # (cells + 1, N)
    sxy: np.ndarray  # (cells, N)


class Fault(NamedTuple):
    """State of the bottom, each of shape (N,); its slip is in units of the weakening above."""

    tau: np.ndarray
    nucleus: np.ndarray  # whether friction is 0
    sliding: np.ndarray
    slip: np.ndarray
    slip_at_release: np.ndarray
    release_time: np.ndarray
    stick_time: np.ndarray
    excess: np.ndarray  # load less strength at the last step, of nodes at rest
    work: np.ndarray  # (2,): by the pre-stress, and by the pre-stress less friction; over h


@inner()
def update_stresses(elastic, fields, first, last):
    """Advance the stresses of columns first to last by one step."""
    vx, vy, sxx, syy, sxy = fields
    rows, ratio = vy.shape[0], elastic.ratio
    for j in range(rows + 1):
        direct, lateral = ratio * elastic.direct[j], ratio * elastic.lateral[j]
        normal = ratio * elastic.normal[j]
        over, under = elastic.above[j], elastic.below[j]
        above, below = vy[min(j, rows - 1), first:last], vy[max(j - 1, 0), first:last]
        v, right = vx[j, first:last], vx[j, first + 1 : last + 1]
        s_xx, s_yy = sxx[j, first:last], syy[j, first:last]
        for i in range(s_xx.shape[0]):
            along, across = right[i] - v[i], over * above[i] - under * below[i]
            s_xx[i] += direct * along + lateral * across
            s_yy[i] += lateral * along + normal * across
        if elastic.mirror:
            sxx[j, 0] = -sxx[j, 1]
    factor = ratio * elastic.shear
    for j in range(rows):
        low, high = vx[j, first:last], vx[j + 1, first:last]
        left, right = vy[j, first - 1 : last - 1], vy[j, first:last]
        s = sxy[j, first:last]
        for i in range(s.shape[0]):
            s[i] += factor * (high[i] - low[i] + right[i] - left[i])


@inner()
def update_velocities(elastic, fields, first, last):
    """Advance the velocities of columns first to last by one step, except v_x at the bottom."""
    vx, vy, sxx, syy, sxy = fields
    rows, ratio = vy.shape[0], elastic.ratio
    for j in range(rows):
        left, right = sxy[j, first:last], sxy[j, first + 1 : last + 1]
        low, high = syy[j, first:last], syy[j + 1, first:last]
        v = vy[j, first:last]
        for i in range(v.shape[0]):
            v[i] += ratio * (right[i] - left[i] + high[i] - low[i])
        if elastic.mirror:
            vy[j, 0] = -vy[j, 1]
    for j in range(1, elastic.moving_rows):
        over, under = elastic.above[j], elastic.below[j]
        left, right = sxx[j, first - 1 : last - 1], sxx[j, first:last]
        low, high = sxy[j - 1, first:last], sxy[min(j, rows - 1), first:last]
        v = vx[j, first:last]
        for i in range(v.shape[0]):
            v[i] += ratio * (right[i] - left[i] + over * high[i] - under * low[i])


@inner()
def strength(elastic, fields, fault, i):
    """Strength of one node, by the slip since its release and by the normal stress on it."""
    if fault.nucleus[i]:
        return 0.0
    weakening = 0.0
    if fault.sliding[i]:
        weakening = (fault.slip[i] - fault.slip_at_release[i]) / elastic.weakening
    normal = 0.5 * (fields.syy[0, i - 1] + fields.syy[0, i])
    return max(0.0, 1.0 - weakening) - elastic.coupling * normal


@inner()
def slide(elastic, fields, fault, i, dt, time):
    """Advance v_x of one node at the bottom by one step, and add up the work."""
    load = fields.sxy[0, i] + 0.5 * (fields.sxx[0, i] - fields.sxx[0, i - 1]) + fault.tau[i]
    resistance = strength(elastic, fields, fault, i)
    if not fault.sliding[i]:
        excess, before = load - resistance, fault.excess[i]
        fault.excess[i] = excess
        if excess < 0.0:
            return
        fault.sliding[i] = True
        fault.slip_at_release[i] = fault.slip[i]
        if np.isnan(fault.release_time[i]):
            # The load is taken as linear in time between two steps.
            late = excess / (excess - before) if before < 0.0 else 0.0
            fault.release_time[i] = time - late * dt
    earlier = fields.vx[0, i]
    later = earlier + 2.0 * elastic.ratio * (load - resistance)
    if later <= 0.0:
        if np.isnan(fault.stick_time[i]):
            # Velocities stand half a step before and after, and are taken as linear between.
            turn = earlier / (earlier - later) if earlier > 0.0 else 0.5
            fault.stick_time[i] = time + (turn - 0.5) * dt
        later = 0.0
        fault.sliding[i] = False
    fields.vx[0, i] = later
    fault.slip[i] += dt * later
    moved = 0.5 * dt * (earlier + later)
    if elastic.mirror and i == 1:
        moved *= 0.5
    # The friction that acted, at a stick too, follows from the change of velocity.
    friction = load - (later - earlier) / (2.0 * elastic.ratio)
    fault.work[0] += abs(fault.tau[i]) * moved
    fault.work[1] += (fault.tau[i] - friction) * moved


@entry
def advance_layer(elastic, fields, fault, dt, steps, columns):
    """Advance between two steps.

    ``columns``: the node at x = 0, the number of columns without friction on each side of it, and
    the number that are advanced behind the compressional wave from it.
    """
    centre, frictionless, trail = columns
    for number in range(steps[0], steps[1]):
        wave = int(number * elastic.ratio)
        reach = frictionless + wave + MARGIN
        first, last = max(1, centre - reach), min(fault.tau.shape[0] - 1, centre + reach)
        first = max(first, centre + wave - trail)
        update_stresses(elastic, fields, first, last)
        update_velocities(elastic, fields, first, last)
        for i in range(first, last):
            slide(elastic, fields, fault, i, dt, number * dt)


def simulate_layer(scene: LayerScene) -> LayerRun:
    """Simulate a rupture; the grid is so long that no wave reaches its ends."""
    h = 1.0 / scene.cells
    dt = COURANT * h / np.sqrt(2.0)
    steps = int(np.ceil(scene.duration / dt))
    reach = int(scene.nucleation / h + 0.5)
    half = reach + int(steps * dt / h) + 2 * MARGIN
    centre = 1 if scene.symmetric else half
    x = (np.arange(centre + half) - centre) * h
    elastic, fields, fault = layer_at_rest(scene, x, dt / h)
    # Without a trail, all columns behind are advanced, also those left of x = 0.
    columns = centre, reach, int(min(scene.trail / h + MARGIN, x.size))
    advance_layer(elastic, fields, fault, dt, (0, steps - 1), columns)
    # The energy is balanced at velocities between two instants of the stresses.
    earlier = Fields._make(array.copy() for array in fields)
    given, kept = fault.work.tolist()
    advance_layer(elastic, fields, fault, dt, (steps - 1, steps), columns)
    energy = stored_energy(elastic, earlier, fields) * h
    return LayerRun(
        x=x[1:-1],
        slip=fault.slip[1:-1] / scene.slip_scale,
        velocity=fields.vx[:, 1:-1] / scene.slip_scale,
        release_time=fault.release_time[1:-1],
        stick_time=fault.stick_time[1:-1],
        energy_residual=float(abs(energy - kept) / given) if math.isinf(scene.trail) else math.nan,
    )


def layer_at_rest(scene: LayerScene, x: np.ndarray, ratio: float) -> tuple[Elastic, Fields, Fault]:
    """A scene's layer at nodes x before t = 0, for steps of ``ratio`` times the spacing."""
    inside = np.ones(scene.cells + 1)
    inside[-1] = scene.top == "held"
    above, below = np.ones(scene.cells + 1), np.ones(scene.cells + 1)
    above[[0, -1]] = 2.0, 0.0
    below[[0, -1]] = 0.0, 2.0
    lateral = 1.0 - scene.gamma
    elastic = Elastic(
        ratio=ratio,
        shear=0.5 * scene.gamma,
        mirror=scene.symmetric,
        moving_rows=scene.cells + (scene.boundary == "stress"),
        coupling=scene.coupling,
        weakening=scene.weakening * scene.slip_scale,
        above=above,
        below=below,
        direct=np.where(inside, 1.0, 1.0 - lateral**2),
        lateral=lateral * inside,
        normal=inside,
    )
    rows = {name: scene.cells + (name not in ("vy", "sxy")) for name in Fields._fields}
    fields = Fields(**{name: np.zeros((count, x.size)) for name, count in rows.items()})
    tau, nucleus = scene.prestress(x), np.abs(x) <= scene.nucleation + 0.25 / scene.cells
    fault = Fault(
        tau=tau,
        nucleus=nucleus,
        sliding=np.zeros(x.size, dtype=bool),
        slip=np.zeros(x.size),
        slip_at_release=np.zeros(x.size),
        release_time=np.full(x.size, np.nan),
        stick_time=np.full(x.size, np.nan),
        excess=tau - np.where(nucleus, 0.0, 1.0),
        work=np.zeros(2),
    )
    return elastic, fields, fault


def stored_energy(elastic: Elastic, earlier: Fields, later: Fields) -> float:
    """Energy of the velocities between two instants of the stresses, over h^2."""
    outer = np.ones((earlier.vx.shape[0], 1))
    outer[[0, -1]] = 0.5
    axis = np.ones(earlier.vx.shape[1])
    axis[0] = 0.0
    nodes = axis.copy()
    nodes[1] = 0.5 if elastic.mirror else 1.0
    kinetic = 0.5 * (np.sum(outer * nodes * earlier.vx**2) + np.sum(axis * earlier.vy**2))
    lateral = elastic.lateral.max()
    direct = earlier.sxx * later.sxx + earlier.syy * later.syy
    crossed = earlier.sxx * later.syy + earlier.syy * later.sxx
    normal = (direct - lateral * crossed) / (1.0 - lateral**2)
    shear = earlier.sxy * later.sxy / elastic.shear
    return float(kinetic + 0.5 * (np.sum(outer * axis * normal) + np.sum(nodes * shear)))
