"""Every prediction for every run of a sweep, one row a run."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial
from typing import TypeVar

import numpy as np
import pandas as pd

from ..model.balance import prestress_balance_position
from ..model.prestress import Prestress
from ..model.roots import root_between
from ..model.scene import Scene
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import exact_transition_displacement
from ..theory.front_law import front_speed, front_speed_undamped, lattice_front_speed
from ..theory.pulse import SteadyPulse, paper_pulse, pulse_behind_front
from .final_regime import UNDECIDED, final_regime, growth_beyond

Found = TypeVar("Found")
NAN = float("nan")
SIDES = {"left": -1e300, "right": 1e300}
# Where blocks are smaller, gamma dx^2 below this, leaf springs hardly change the speed of a damped front, and finding
# how much takes 14 ms a run.
COARSE = 1e-3
ARRESTS = (0.9, 0.95, 0.99)


def predictions(scenes: Sequence[Scene], fraction: float, still: float) -> pd.DataFrame:
    """What the paper and the exact theory predict of each run; NaN where they say nothing.

    Parameters
    ----------
    scenes : in the order of the sweep
    fraction : of |x_minus| that the left front covers at T_trans under a stress boundary
    still : fraction of the largest velocity below which the nucleation point is at rest (`final_regime`)

    Returns
    -------
    one row a run: paper_front_speed_SIDE, exact_front_speed_SIDE (no leaf springs), lattice_front_speed_SIDE (leaf
    springs at this dx); the right pulse under a displacement boundary, paper_pulse_SIZE (undamped) and
    exact_pulse_SIZE; exact_transition_time and _length, exact_first_stick_time; under a stress boundary
    exact_balance_distance, exact_largest_velocity, exact_half_width (of the far pulse), exact_arrest_time_90 (when the
    left front has covered 90 % of |x_minus|) and so on; exact_regime, the one that the rupture ends in

    Source: `theory`. Numbers of the transition are given for a Gaussian of peak 1 without steps and bumps.
    """
    found = pd.concat([_front_speeds(scenes, side) for side in SIDES], axis=1)
    rows: list[dict[str, float | str]] = []
    for scene, speed in zip(scenes, found["exact_front_speed_right"], strict=True):
        numbers = _displacement(scene) if scene.boundary == "displacement" else _stress(scene, fraction)
        rows.append({**_pulse(scene, speed), **numbers, "exact_regime": _regime(scene, still)})
    return found.join(pd.DataFrame(rows, index=found.index))


def _level(scene: Scene, side: str) -> float:
    return float(scene.prestress.level(np.asarray(SIDES[side])))


def _ratio(scene: Scene) -> float:
    """beta/dx; equal ones to the last digit, whatever dx."""
    return float(f"{scene.damping_ratio:.12g}")


def _front_speeds(scenes: Sequence[Scene], side: str) -> pd.DataFrame:
    levels = np.array([_level(scene, side) for scene in scenes])
    ratios = np.array([_ratio(scene) for scene in scenes])
    out = {f"{kind}_front_speed_{side}": np.full(levels.shape, NAN) for kind in ("paper", "exact", "lattice")}
    paper, exact, lattice = out.values()
    outruns = (levels > 0.0) & (levels < 1.0)
    paper[outruns] = front_speed_undamped(levels[outruns])
    for release in ("total", "elastic"):
        chosen = outruns & [scene.release == release for scene in scenes]
        if chosen.any():
            pairs, back = np.unique([levels[chosen], ratios[chosen]], axis=1, return_inverse=True)
            exact[chosen] = front_speed(pairs[0], pairs[1], release)[back.ravel()]
    for i, scene in enumerate(scenes):
        if outruns[i] and scene.gamma > 0.0 and (ratios[i] == 0.0 or scene.gamma * scene.dx**2 >= COARSE):
            lattice[i] = _with_springs(levels[i], scene.gamma, scene.dx, ratios[i], scene.release)
    return pd.DataFrame(out)


def _known(find: Callable[[], Found]) -> Found | None:
    """What theory has; None outside the domain that it states by a ValueError, or where numbers are too large."""
    try:
        return find()
    except (ValueError, ArithmeticError):
        return None


def or_nan(find: Callable[[], float]) -> float:
    """A number that theory has; NaN where it says that it has none."""
    found = _known(find)
    return NAN if found is None else float(found)


@cache
def _with_springs(level: float, gamma: float, dx: float, ratio: float, release: str) -> float:
    # Under strong springs no front outruns the waves.
    return or_nan(lambda: lattice_front_speed(level, gamma, dx, ratio, release))


def _pulse(scene: Scene, speed: float) -> dict[str, float]:
    """The right pulse by the paper's formulas and with damping, where there are leaf springs."""
    level = _level(scene, "right")
    paper = exact = None
    if scene.boundary == "displacement" and 0.0 < level < 1.0:
        paper = _known(lambda: paper_pulse(level, scene.gamma))
        if speed > 1.0:
            exact = _known(lambda: pulse_behind_front(level, scene.gamma, scene.beta, speed))
    out = {}
    for kind, pulse in (("paper", paper), ("exact", exact)):
        for name in ("width", "slip", "peak_velocity"):
            out[f"{kind}_pulse_{name}"] = getattr(pulse, name) if pulse else NAN
        out[f"{kind}_pulse_acceleration"] = _acceleration(pulse) if pulse else NAN
    return out


def _acceleration(pulse: SteadyPulse) -> float:
    """Amplitude by projection on the sine, as it is measured (`measure.pulses.acceleration_amplitude`)."""
    nodes, weights = np.polynomial.legendre.leggauss(32)
    xi = -0.5 * pulse.width * (1.0 + nodes)
    shape = np.cos(np.pi * xi / pulse.width)
    return float(np.sum(weights * pulse.profile(xi)[2] * shape) / np.sum(weights * shape**2))


def _plain(profile: Prestress) -> bool:
    return not profile.steps and not profile.bumps and profile.peak == 1.0


def _displacement(scene: Scene) -> dict[str, float]:
    profile = scene.prestress
    time = length = NAN
    if _plain(profile) and profile.left == profile.right > 0.0:
        time, length = _first_stick(profile.left, profile.width, scene.gamma, _ratio(scene), scene.release)
    return {"exact_transition_time": time, "exact_transition_length": length, "exact_first_stick_time": time}


@cache
def _first_stick(level: float, width: float, gamma: float, ratio: float, release: str) -> tuple[float, float]:
    profile = Prestress(level, level, width)
    # More panels than theory allows, or more damping.
    exact = _known(lambda: exact_transition_displacement(profile, gamma, ratio, release))
    return (exact.time, exact.length) if exact else (NAN, NAN)


def _stress(scene: Scene, fraction: float) -> dict[str, float]:
    profile = scene.prestress
    out = {}
    if _level(scene, "left") < 0.0 == _level(scene, "right"):
        out["exact_balance_distance"] = -or_nan(lambda: prestress_balance_position(profile))
    if _plain(profile) and profile.left < 0.0 == profile.right:
        # All lengths and times go with the width.
        unit = _arrest(profile.left, _ratio(scene), scene.release, fraction)
        out |= {name: value * profile.width for name, value in unit.items()}
    return out


@cache
def _arrest(left: float, ratio: float, release: str, fraction: float) -> dict[str, float]:
    """Numbers of the left front and of the far pulse behind a Gaussian of width 1."""
    crack = _known(lambda: ArrestingCrack(Prestress(left, 0.0), ratio, release))
    if crack is None:
        return {}
    numbers: dict[str, Callable[[], float]] = {
        "exact_largest_velocity": lambda: crack.peak_velocity,
        "exact_half_width": lambda: _half_width(crack),
        "exact_transition_time": lambda: crack.share_time(fraction),
        "exact_transition_length": lambda: crack.share_length(fraction),
    }
    for each in ARRESTS:
        numbers[f"exact_arrest_time_{100.0 * each:g}"] = partial(crack.share_time, each)
        numbers[f"exact_arrest_length_{100.0 * each:g}"] = partial(crack.share_length, each)
    # Very near x_minus the front is held by what theory leaves out.
    return {name: or_nan(find) for name, find in numbers.items()}


def _half_width(crack: ArrestingCrack) -> float:
    """Width of the far pulse at half of its peak.

    Source: du/dt is half the integral of tau from the entry point on, on each side of its zero (`ArrestingCrack`).
    """
    far = 4.0 * crack.far

    def above_half(x: float) -> float:
        return crack.prestress.integral(x, far) - crack.peak_velocity

    ahead = root_between(above_half, crack.zero, far, xtol=1e-12)
    behind = root_between(above_half, crack.balance_position, crack.zero, xtol=1e-12)
    return float((ahead - float(crack.fronts.arrival(ahead))) - (behind - crack.time_at(behind)))


def _regime(scene: Scene, still: float) -> str:
    profile = scene.prestress
    if profile.bumps:
        return UNDECIDED
    if profile.steps:
        # A pulse that formed where the pre-stress is 0 meets another level.
        formed = scene.boundary == "stress" and profile.left < 0.0 == profile.right
        ahead = all(position > 0.0 for position, _ in profile.steps)
        return growth_beyond(_level(scene, "right")) if formed and ahead else UNDECIDED
    return final_regime(profile.left, profile.right, scene.gamma, _ratio(scene), scene.release, still)
