"""The elastic layer in the plane, solved without the average over its height that the paper takes.

Plane strain, 0 <= y <= 1 in units of the thickness H, lengths in H, times in H over the compressional wave speed,
stresses in (mu_s - mu_k) sigma_n; all fields are changes from the state of rest under the pre-stress. Velocities v
and stresses s obey

    dv_x/dt = ds_xx/dx + ds_xy/dy        ds_xx/dt = dv_x/dx + (1 - gamma) dv_y/dy
    dv_y/dt = ds_xy/dx + ds_yy/dy        ds_yy/dt = (1 - gamma) dv_x/dx + dv_y/dy
                                         ds_xy/dt = (gamma/2) (dv_x/dy + dv_y/dx)

with gamma = 2G/(lambda + 2G) as in section II of the paper. They stand on a staggered grid: v_x, s_xx and s_yy on rows
y = j h from boundary to boundary (the two outer rows have half the height of a cell), v_y and s_xy between two rows;
s_xx, s_yy and v_y lie half a cell to the right of v_x and s_xy. Velocities stand at half steps of time. The scheme
conserves a discrete energy, so that what is lost to friction is known to rounding.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from ..model.checks import check_choice, check_number
from ..model.prestress import Prestress
from .jit import entry, inner

# Fraction of the largest stable time step, h / sqrt(2).
COURANT = 0.85
# Nothing moves ahead of the compressional wave but precursors of the grid: cells kept for them beyond it.
MARGIN = 32


@dataclass(frozen=True)
class LayerScene:
    """A rupture of the layer in the plane, with friction that weakens linearly with slip.

    Parameters
    ----------
    boundary : held at the top, "displacement" (v_x = 0) or "stress" (s_xy = 0)
    gamma : 2G/(lambda + 2G), in (0, 1)
    prestress : shear stress tau(x) at the bottom before the rupture, as in `Scene`
    weakening : slip d_c over which the strength falls from 1 to 0 (units of U), > 0
    duration : end of the run, > 0
    cells : cells of the grid a thickness, >= 4
    nucleation : friction is 0 for |x| <= this from t = 0 on, >= 0
    bottom, top : normal displacement there, "held" or "free" (no normal stress)
    coupling : friction coefficient mu of a strength that follows the normal stress, - mu s_yy, >= 0

    Raises ValueError: outside these ranges, and for a coupling at a bottom that is free.
    """

    boundary: str
    gamma: float
    prestress: Prestress
    weakening: float
    duration: float
    cells: int = 40
    nucleation: float = 2.0
    bottom: str = "held"
    top: str = "held"
    coupling: float = 0.0

    def __post_init__(self) -> None:
        check_choice("boundary", self.boundary, ("displacement", "stress"))
        check_number("gamma", self.gamma, above=0.0, below=1.0)
        check_number("weakening", self.weakening, above=0.0)
        check_number("duration", self.duration, above=0.0)
        check_number("cells", self.cells, at_least=4)
        check_number("nucleation", self.nucleation, at_least=0.0)
        check_choice("bottom", self.bottom, ("held", "free"))
        check_choice("top", self.top, ("held", "free"))
        check_number("coupling", self.coupling, at_least=0.0)
        if self.coupling > 0.0 and self.bottom == "free":
            raise ValueError("coupling: 0 is allowed at a free bottom, which has no normal stress")

    @property
    def slip_scale(self) -> float:
        """U over H (mu_s - mu_k) sigma_n/(lambda + 2G), by appendix B of the paper."""
        return 2.0 if self.boundary == "displacement" else 1.0

    @property
    def symmetric(self) -> bool:
        """Whether the half x >= 0 is enough."""
        return self.prestress.symmetric and self.coupling == 0.0


@dataclass(frozen=True)
class LayerRun:
    """What became of the bottom of the layer, at its N positions."""

    x: np.ndarray  # (N,) position
    slip: np.ndarray  # (N,) slip at the end, in units of U
    velocity: np.ndarray  # (N,) slip velocity at the end
    release_time: np.ndarray  # (N,) first release, NaN where never
    stick_time: np.ndarray  # (N,) last stick, NaN where never
    energy_residual: float  # unbalanced energy over the work of the pre-stress
    updates: int  # cells times steps


class Elastic(NamedTuple):
    """Constants of the layer and of its grid."""

    ratio: float  # dt/h
    shear: float  # gamma/2
    lateral: float  # 1 - gamma
    thin: float  # modulus of s_xx where s_yy is 0
    mirror: bool  # node 1 lies on an axis of symmetry
    held_top: bool  # v_x is 0 there
    free_bottom: bool
    free_top: bool
    coupling: float  # mu
    weakening: float  # d_c in units of H (mu_s - mu_k) sigma_n/(lambda + 2G)


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
    work: np.ndarray  # (2,): by the pre-stress, and by the pre-stress less friction; over h


@inner()
def update_stresses(elastic, fields, first, last):
    """Advance the stresses of columns first to last by one step."""
    vx, vy, sxx, syy, sxy = fields
    rows, ratio, lateral = vy.shape[0], elastic.ratio, elastic.lateral
    for j in range(rows + 1):
        # An outer row has half a cell, whose other side is held.
        above = vy[min(j, rows - 1), first:last]
        below = vy[max(j - 1, 0), first:last]
        up = ratio * (2.0 if j == 0 else 1.0 if j < rows else 0.0)
        down = ratio * (2.0 if j == rows else 1.0 if j > 0 else 0.0)
        v, right = vx[j, first:last], vx[j, first + 1 : last + 1]
        s_xx, s_yy = sxx[j, first:last], syy[j, first:last]
        if (j == 0 and elastic.free_bottom) or (j == rows and elastic.free_top):
            for i in range(s_xx.shape[0]):
                s_xx[i] += ratio * elastic.thin * (right[i] - v[i])
        else:
            for i in range(s_xx.shape[0]):
                along, across = ratio * (right[i] - v[i]), up * above[i] - down * below[i]
                s_xx[i] += along + lateral * across
                s_yy[i] += lateral * along + across
        if elastic.mirror:
            sxx[j, 0] = -sxx[j, 1]
    factor = ratio * elastic.shear
    for j in range(rows):
        low, high, s = vx[j, first:last], vx[j + 1, first:last], sxy[j, first:last]
        v, left = vy[j, first:last], vy[j, first - 1 : last - 1]
        for i in range(s.shape[0]):
            s[i] += factor * (high[i] - low[i] + v[i] - left[i])


@inner()
def update_velocities(elastic, fields, first, last):
    """Advance the velocities of columns first to last by one step, but those at the bottom."""
    vx, vy, sxx, syy, sxy = fields
    rows, ratio = vy.shape[0], elastic.ratio
    for j in range(rows):
        v, s, right = vy[j, first:last], sxy[j, first:last], sxy[j, first + 1 : last + 1]
        low, high = syy[j, first:last], syy[j + 1, first:last]
        for i in range(v.shape[0]):
            v[i] += ratio * (right[i] - s[i] + high[i] - low[i])
        if elastic.mirror:
            vy[j, 0] = -vy[j, 1]
    for j in range(1, rows if elastic.held_top else rows + 1):
        # Nothing pulls at the upper side of a free top, whose cell has half the height.
        up, down = (ratio, ratio) if j < rows else (0.0, 2.0 * ratio)
        v, s, left = vx[j, first:last], sxx[j, first:last], sxx[j, first - 1 : last - 1]
        low, high = sxy[j - 1, first:last], sxy[min(j, rows - 1), first:last]
        for i in range(v.shape[0]):
            v[i] += ratio * (s[i] - left[i]) + up * high[i] - down * low[i]


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
def slide(elastic, fields, fault, step, columns):
    """Advance the velocities at the bottom by one step, with releases and sticks. Adds up the work."""
    velocity, slip, sliding = fields.vx[0], fault.slip, fault.sliding
    dt, number = step
    first, last = columns
    for i in range(first, last):
        load = fields.sxy[0, i] + 0.5 * (fields.sxx[0, i] - fields.sxx[0, i - 1]) + fault.tau[i]
        resistance = strength(elastic, fields, fault, i)
        if not sliding[i]:
            if load < resistance:
                continue
            sliding[i] = True
            fault.slip_at_release[i] = slip[i]
            if np.isnan(fault.release_time[i]):
                fault.release_time[i] = number * dt
        before = velocity[i]
        after = before + 2.0 * elastic.ratio * (load - resistance)
        if after <= 0.0:
            after = 0.0
            sliding[i] = False
            fault.stick_time[i] = number * dt
        velocity[i] = after
        slip[i] += dt * after
        weight = 0.5 if elastic.mirror and i == 1 else 1.0
        moved = weight * 0.5 * dt * (before + after)
        # The friction that acted, a stick's included, follows from the change of velocity.
        acted = load - (after - before) / (2.0 * elastic.ratio)
        fault.work[0] += abs(fault.tau[i]) * moved
        fault.work[1] += (fault.tau[i] - acted) * moved


@entry
def advance_layer(elastic, fields, fault, dt, start, end, centre):
    """Advance from step ``start`` to ``end``; nothing has moved farther from node ``centre`` than the first says."""
    columns = fault.tau.shape[0]
    for number in range(start, end):
        reach = centre[1] + int(number * elastic.ratio) + MARGIN
        first, last = max(1, centre[0] - reach), min(columns - 1, centre[0] + reach)
        update_stresses(elastic, fields, first, last)
        update_velocities(elastic, fields, first, last)
        slide(elastic, fields, fault, (dt, number), (first, last))


def simulate_layer(scene: LayerScene) -> LayerRun:
    """Simulate a rupture of the layer in the plane; the grid is so long that no wave reaches its ends."""
    h = 1.0 / scene.cells
    dt = COURANT * h / np.sqrt(2.0)
    steps = int(np.ceil(scene.duration / dt))
    reach = int(scene.nucleation / h + 0.5)
    half = reach + int(steps * dt / h) + 2 * MARGIN
    centre = 1 if scene.symmetric else half
    x = (np.arange(centre + half) - centre) * h
    elastic = elastic_layer(scene, dt / h)
    rows = (scene.cells + 1, scene.cells, scene.cells + 1, scene.cells + 1, scene.cells)
    fields = Fields(*(np.zeros((count, x.size)) for count in rows))
    fault = new_fault(scene, x, h)
    advance_layer(elastic, fields, fault, dt, 0, steps, (centre, reach))
    # The work is balanced between two instants of the stresses: one step more gives the second.
    earlier = [array.copy() for array in fields]
    work = fault.work.copy()
    run = LayerRun(
        x=x[1:-1],
        slip=fault.slip[1:-1] / scene.slip_scale,
        velocity=earlier[0][0, 1:-1] / scene.slip_scale,
        release_time=fault.release_time[1:-1].copy(),
        stick_time=fault.stick_time[1:-1].copy(),
        energy_residual=0.0,
        updates=steps * scene.cells * x.size,
    )
    advance_layer(elastic, fields, fault, dt, steps, steps + 1, (centre, reach))
    energy = stored_energy(elastic, Fields(*earlier), fields) * h
    return replace(run, energy_residual=float(abs(energy - work[1]) / work[0]))


def elastic_layer(scene: LayerScene, ratio: float) -> Elastic:
    """Constants of a scene's layer for steps of ``ratio`` times the spacing."""
    lateral = 1.0 - scene.gamma
    return Elastic(
        ratio=ratio,
        shear=0.5 * scene.gamma,
        lateral=lateral,
        thin=1.0 - lateral**2,
        mirror=scene.symmetric,
        held_top=scene.boundary == "displacement",
        free_bottom=scene.bottom == "free",
        free_top=scene.top == "free",
        coupling=scene.coupling,
        weakening=scene.weakening * scene.slip_scale,
    )


def new_fault(scene: LayerScene, x: np.ndarray, h: float) -> Fault:
    """The bottom at rest, under the pre-stress at its nodes, before t = 0."""
    return Fault(
        tau=scene.prestress(x),
        nucleus=np.abs(x) <= scene.nucleation + 0.25 * h,
        sliding=np.zeros(x.size, dtype=bool),
        slip=np.zeros(x.size),
        slip_at_release=np.zeros(x.size),
        release_time=np.full(x.size, np.nan),
        stick_time=np.full(x.size, np.nan),
        work=np.zeros(2),
    )


def stored_energy(elastic: Elastic, earlier: Fields, later: Fields) -> float:
    """Energy of the velocities between two instants of the stresses, over h^2, which the scheme conserves."""
    outer = np.ones((earlier.vx.shape[0], 1))
    outer[[0, -1]] = 0.5
    axis = np.ones(earlier.vx.shape[1])
    axis[0] = 0.0
    nodes = axis.copy()
    nodes[1] = 0.5 if elastic.mirror else 1.0
    kinetic = 0.5 * (np.sum(outer * nodes * earlier.vx**2) + np.sum(axis * earlier.vy**2))
    direct = earlier.sxx * later.sxx + earlier.syy * later.syy
    crossed = earlier.sxx * later.syy + earlier.syy * later.sxx
    normal = (direct - elastic.lateral * crossed) / (1.0 - elastic.lateral**2)
    shear = earlier.sxy * later.sxy / elastic.shear
    return float(kinetic + 0.5 * (np.sum(outer * axis * normal) + np.sum(nodes * shear)))
