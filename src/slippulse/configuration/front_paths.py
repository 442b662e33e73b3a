"""Where the fronts of a scene are, and for how long a block slides: roughly, in a fraction of a millisecond.

For estimates of cost and nothing else: a front runs at the speed that it would have if the pre-stress were everywhere
what it is here, and the speed is interpolated between its limits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from ..model.prestress import Prestress
from ..model.scene import Scene
from .fading import fading_rate
from .momentum import momentum_limits

# Neighbouring positions differ by this factor, from a thousandth of the Gaussian's width outwards.
RATIO, NEAREST = 1.25, 1e-3
# Positions around a bump, in its widths.
AROUND = np.linspace(-4.0, 4.0, 17)
# Where the damping of the rule "elastic" is half way between its limits.
HALF_WAY = 0.55
# Strongly damped blocks creep for so many times beta, where the way is shorter (measured).
CREEPING = 10.0
# Fronts fade beyond so many widths of the Gaussian.
NUCLEUS = 1.6
# A front that arrests covers a cell in this time: longer than any run.
STOPPED = 1e9


@dataclass(frozen=True)
class FrontPaths:
    """Cells of the line, left to right.

    Attributes
    ----------
    size : of each cell
    level : pre-stress there
    speed : of the front there
    x : middle of each cell
    start : 0 where the run begins with a release, infinite elsewhere
    later, spent : without leaf springs, how much later a front comes for want of momentum, and when that of a block is
        used up; infinite where it does not come, or where momentum lasts
    stopped : where the left and the right front arrest; infinite where they do not
    release : when the first of all fronts comes by
    """

    size: np.ndarray
    level: np.ndarray
    speed: np.ndarray
    x: np.ndarray
    start: np.ndarray
    later: np.ndarray
    spent: np.ndarray
    stopped: tuple[float, float] = (-math.inf, math.inf)
    release: np.ndarray | None = None

    def with_stops(self, left: float, right: float) -> FrontPaths:
        """The same with fronts that arrest where it is said."""
        slowness = self.size / self.speed
        slowness[(self.x < left) | (self.x > right)] += STOPPED
        # From what is released at the start to the right, and to the left.
        passed = np.cumsum(slowness)
        before = passed - slowness
        rightwards = before + np.minimum.accumulate(self.start - before)
        leftwards = np.minimum.accumulate((self.start + passed)[::-1])[::-1] - passed
        release = np.minimum(rightwards, leftwards)
        return replace(self, stopped=(left, right), release=release)


def approximate_speed(level: np.ndarray, ratio: float, release: str) -> np.ndarray:
    """Speed of a steady front, within 30 % of what it has above 1; 1 where the level is not positive.

    Parameters
    ----------
    level : pre-stress ahead
    ratio : beta/dx, >= 0
    release : "total" or "elastic"

    Source: exact without damping, and for "total" at beta/dx = 1, v = 1/(1 - tau); "elastic" tends to (1 - tau)^-1/2.
    """
    tau = np.clip(level, 0.0, 1.0 - 1e-16)
    undamped = 1.0 / np.sqrt((1.0 - tau) * (1.0 + tau))
    if release == "total":
        return undamped + ratio * tau / (1.0 - tau)
    share = ratio / (ratio + HALF_WAY)
    return (1.0 - share) * undamped + share / np.sqrt(1.0 - tau)


def front_paths(scene: Scene) -> FrontPaths:
    """Paths of all fronts of a scene."""
    # By the textbook scheme a front covers a block a step at most.
    fastest = 1.0 / scene.max_step if scene.scheme == "fixed_step" else math.inf
    profile, ratio, release = scene.prestress, scene.damping_ratio, scene.release
    levels = [profile.left, profile.right, *(level for _, level in profile.steps)]
    fast = min(fastest, float(approximate_speed(np.array(max(levels)), ratio, release)))
    reach = max(1.0, 10.0 * profile.width, 2.0 * fast * scene.duration)
    reach += max((abs(centre) + 10.0 * width for centre, _, width in profile.bumps), default=0.0)
    # Few different ones, so that the scenes of a sweep share their cells.
    cells = _cells(
        profile, ratio, release, fastest, 4.0 ** math.ceil(math.log(reach, 4.0)), scene.gamma > 0.0
    )
    if scene.gamma:
        cells = cells.with_stops(*_stopped(profile, cells, scene))
    else:
        comes = cells.release + cells.later
        never = ~(comes < cells.spent) & (cells.start > 0.0)
        cells = replace(cells, release=np.where(never, np.maximum(cells.release, STOPPED), comes))
    if release == "elastic" and ratio > 1.0 and scene.scheme != "continuum":
        delay, begins = _viscous_delay(cells, scene), np.isfinite(cells.start)
        # From where the run begins, which is released at once.
        delay = np.where(begins, 0.0, delay - np.min(delay[begins], initial=np.max(delay)))
        return replace(cells, release=np.maximum(cells.release, delay))
    return cells


@lru_cache(maxsize=1024)
def _cells(
    profile: Prestress, ratio: float, release: str, fastest: float, reach: float, springs: bool
) -> FrontPaths:
    """Paths of fronts that arrest nowhere, as far as they may come."""
    near = NEAREST * min(profile.width, 1.0)
    outwards = near * RATIO ** np.arange(math.ceil(math.log(reach / near) / math.log(RATIO)))
    places = [-outwards[::-1], [0.0], outwards]
    places += [centre + width * AROUND for centre, _, width in profile.bumps]
    places += [[math.nextafter(position, 0.0), position] for position, _ in profile.steps]
    edges = np.concatenate(places)
    if len(places) > 3:
        edges.sort()
        edges = edges[np.concatenate([[True], edges[1:] > edges[:-1]])]
    x, size = 0.5 * (edges[1:] + edges[:-1]), edges[1:] - edges[:-1]
    level = profile(x)
    start = np.where(level >= 1.0, 0.0, math.inf)
    if float(profile(0.0)) >= 1.0:
        start[[np.searchsorted(x, 0.0) - 1, np.searchsorted(x, 0.0)]] = 0.0
    speed = np.minimum(approximate_speed(level, ratio, release), fastest)
    later, spent = np.zeros(x.size), np.full(x.size, math.inf)
    begins = np.isfinite(start)
    if np.any(level < 0.0) and begins.any() and not springs:
        middle = 0.0 if begins[np.searchsorted(x, 0.0)] else float(np.mean(x[begins]))
        # That which drives the start is the Gaussian, or the bumps that reach the threshold.
        bumps = [width for centre, _, width in profile.bumps if float(profile(centre)) >= 1.0]
        widest = max(bumps, default=profile.width) if middle else profile.width
        later, spent = momentum_limits(x - middle, np.cumsum(size * level), 4.0 * widest)
    return FrontPaths(size, level, speed, x, start, later, spent).with_stops(-math.inf, math.inf)


def _viscous_delay(cells: FrontPaths, scene: Scene) -> np.ndarray:
    """The time that a front takes where strong damping keeps the elastic stress ahead of it below the threshold.

    Released blocks share the push P on them through their damping, so that the strain at their edge grows as
    P t/(2 beta). It frees the next block at the strain (1 - tau) dx, and begins anew at the next one.
    """
    total, distance = np.cumsum(cells.size * np.maximum(cells.level, 0.0)), np.abs(cells.x)
    push = np.interp(distance, cells.x, total) - np.interp(-distance, cells.x, total)
    delay = 2.0 * scene.beta * np.maximum(1.0 - cells.level, 0.0) / np.maximum(push, scene.dx) * cells.size
    right = cells.x > 0.0
    delay[right] = np.cumsum(delay[right])
    delay[~right] = np.cumsum(delay[~right][::-1])[::-1]
    return delay


def _stopped(profile: Prestress, cells: FrontPaths, scene: Scene) -> tuple[float, float]:
    """Where the push behind each outward front is used up, or where it has faded.

    The push is the integral of the pre-stress over the side; with leaf springs over a length of pi/sqrt(gamma) of it.
    """
    x, size, level, gamma = cells.x, cells.size, cells.level, scene.gamma
    push, ends = size * level, []
    memory = math.pi / math.sqrt(gamma)
    nucleus = NUCLEUS * profile.width / max(1.0, gamma * scene.dx**2)
    fading = np.where(np.abs(x) > nucleus, size * fading_rate(level, scene), 0.0)
    for side, outwards in ((x < 0.0, -1), (x > 0.0, 1)):
        along, places, lengths = push[side][::outwards], x[side][::outwards], size[side][::outwards]
        total = np.cumsum(along)
        most = memory * np.maximum.accumulate(np.clip(along / lengths, 0.0, 1.0))
        total -= np.maximum.accumulate(np.maximum(total - most, 0.0))
        left = total / np.maximum.accumulate(np.maximum(total, 1e-300)) - np.cumsum(fading[side][::outwards])
        used_up = np.flatnonzero(left <= 0.0)
        inner = places - 0.5 * outwards * lengths
        end = float(inner[used_up[0]]) if used_up.size else outwards * math.inf
        # Where the run begins elsewhere, that may be beyond.
        begins = cells.start[side][::outwards][np.abs(places) > abs(end)] == 0.0
        ends.append(outwards * math.inf if float(profile(0.0)) < 1.0 and begins.any() else end)
    return ends[0], ends[1]


def viscous(scene: Scene, paths: FrontPaths) -> bool:
    """Whether blocks creep to where they stick: by "total" only if less slips than damping spreads over (measured)."""
    slips = float(np.sum(paths.size[paths.release < scene.duration]))
    return scene.scheme != "continuum" and (scene.release == "elastic" or slips < 3.5 * scene.beta)


def sliding_times(scene: Scene, paths: FrontPaths) -> np.ndarray:
    """For how long a block of each cell slides.

    Parameters
    ----------
    scene, paths : a scene and its paths

    Source: the steady pulse at the front's speed, without damping pi sqrt(v^2 - 1)/(v sqrt(gamma)), strongly damped the
    root of beta v k^3 = gamma; without leaf springs blocks stick when a wave from where the fronts arrest comes by.
    """
    left, right = paths.stopped
    stuck = paths.spent
    for end in (left, right):
        if scene.gamma and math.isfinite(end):
            arrival = paths.release[np.searchsorted(paths.x, end) - (1 if end > 0.0 else 0)]
            stuck = np.minimum(stuck, arrival + np.abs(paths.x - end))
    sliding = np.maximum(stuck - paths.release, 0.0)
    if viscous(scene, paths):
        sliding += CREEPING * scene.beta**2 / (scene.beta + np.minimum(sliding, 1e9) + scene.dx)
    if scene.boundary == "stress":
        return sliding
    v, beta = np.maximum(paths.speed, 1.0), 0.0 if scene.scheme == "continuum" else scene.beta
    with np.errstate(divide="ignore"):
        undamped = np.sqrt(scene.gamma / ((v - 1.0) * (v + 1.0)))
        damped = 0.5 * math.sqrt(3.0) * np.cbrt(scene.gamma / (beta * v)) if beta else math.inf
        pulse = math.pi / (np.minimum(undamped, damped) * v)
    # At the wave speed, the first wave of the leaf springs.
    way = np.abs(paths.x)
    return np.minimum(np.maximum(pulse, np.hypot(way, math.pi / math.sqrt(scene.gamma)) - way), sliding)
