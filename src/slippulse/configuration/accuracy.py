"""Spacing, step and order of a scene for a largest relative error of its numbers.

The error of each number is a constant times dx over a length of the scene, in the continuum limit at fixed beta/dx.
The constants below stand here once. Where no derivation is given they are upper bounds over runs at two or three
spacings: tau_0 = 0.1 to 0.9, beta/dx = 0 to 1, gamma W^2 = 0.001 to 64 under a displacement boundary; levels -0.1 to
-10 under a stress boundary. What is promised, and what is not, is in `slippulse.measure.promise`.
"""

import math
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from ..model.checks import check_choice, check_kind, check_number, short_repr
from ..model.prestress import Prestress
from ..model.scene import RELEASES, Scene
from ..model.stability import MARGIN, largest_step
from ..theory.front_speeds import front_speed
from ..theory.pulse import pulse_behind_front
from .expand import promise_of, runs
from .problems import ConfigError

# At beta/dx = 10 the longest stable step alone errs by 3e-3 in the front speed, at any spacing, which a grid study does
# not see; the constants below were found up to 1.
STRONGEST_DAMPING = 1.0
# Fraction of the promise that the spacing may take; the rest is left to the step and to the scatter of a grid study,
# which with factors of 1.5 and 2 finds up to a third more than the error is.
FRACTION = 0.7
# Blocks across the narrowest length at the least, so that a lattice four times coarser still has 8.
BLOCKS = 32
# Largest step in units of dx, and order: `studies.accuracy_cost` finds errors of 4e-6 by them at any spacing, in the
# worst of its numbers, and by the next cheaper ones 2e-5.
STEP, ORDER = 1.0, 8

# Pulse: the damped layer, (beta/dx) v/(v^2 - 1) blocks, takes pi^2/4 times its fraction of the width from slip and peak
# (steady pulse to first order in beta). The front takes blocks from the width: at most 1/(2 tau_0 v^2).
LAYER, FRONT_BLOCKS = 0.25 * math.pi**2, 0.5
# Front speed over leaf springs, second order in dx over the pulse width: transient, and layer times v.
SPEED, SPEED_LAYER = 7.0, 4.0
# T_trans and L_trans under a displacement boundary: blocks of the nucleation, a front slow to start.
NUCLEATION, SLOW_FRONT = 0.1, 0.2
# Share time and pulse under a stress boundary with level 0 on the right, over the distance to where the pre-stress
# falls to 0 on the left; for each, undamped and what beta/dx adds.
SHARE_TIME, SHARE_TIME_DAMPED = 2.2, 1.0
VELOCITY, VELOCITY_DAMPED = 0.6, 0.6
# Front speed without leaf springs, over the width of the Gaussian.
FREE_SPEED = 0.25

# Runs of a sweep have it in common, and it takes milliseconds.
speed_of = lru_cache(maxsize=4096)(front_speed)


def settings_for(
    accuracy: float,
    *,
    boundary: str,
    prestress: Prestress,
    gamma: float = 0.0,
    damping_ratio: float = 0.0,
    release: str = "total",
    fields: bool = True,
) -> dict[str, Any]:
    """Spacing, step and order that keep a scene's numbers within a largest relative error.

    accuracy : largest relative numerical error, 1e-4 to 0.1
    boundary, prestress, gamma, release : of the scene, as in `Scene`
    damping_ratio : beta/dx, which stays as the spacing changes, 0 to 1
    fields : whether the numbers of the pulse at the end (width, slip, peak velocity) are wanted too

    Returns a dict of dx, beta, max_step and order, to be passed on: ``Scene(..., **settings)``
    Raises ValueError: one line naming the key, the value and what is allowed.
    Source: module docstring; the numbers that are covered are listed in `slippulse.measure.promise`.
    """
    check_number("accuracy", accuracy, at_least=1e-4, at_most=0.1)
    check_choice("release", release, RELEASES)
    check_kind("prestress", prestress, Prestress)
    if not isinstance(fields, bool):
        raise ValueError(f"fields: {short_repr(fields)}; allowed: true or false")
    check_number("gamma", gamma, at_least=0.0)
    check_number("damping_ratio", damping_ratio, at_least=0.0, at_most=STRONGEST_DAMPING)
    spacings = _spacings(FRACTION * accuracy, prestress, gamma, damping_ratio, release, fields)
    dx = float(f"{min(1.0, *spacings):.3g}")
    step = min(STEP, MARGIN * largest_step("localised", ORDER, damping_ratio, gamma * dx**2))
    settings: dict[str, Any] = {
        "dx": dx,
        "beta": damping_ratio * dx,
        "max_step": step,
        "order": ORDER,
    }
    # Refuses what is left to refuse.
    Scene(
        boundary=boundary,
        prestress=prestress,
        gamma=gamma,
        release=release,
        duration=1.0,
        **settings,
    )
    return settings


def promised(simulation: Mapping) -> Mapping[str, Any]:
    """A resolved simulation, with the spacing of each run where an accuracy is promised; raises ConfigError."""
    promise = promise_of(simulation)
    if promise is not None and simulation["scheme"] != "localised":
        # The error of another scheme's step is not seen by a grid study.
        raise ConfigError(
            f"scheme: {simulation['scheme']!r}; allowed: 'localised' where accuracy is given"
        )
    if promise is None or math.isnan(promise):
        return simulation
    if any(alphas := simulation.get("rate_strengthening", [])):
        # The constants above are those without it; beyond alpha_c no pulse has a width, near -alpha_c slip diverges.
        allowed = "0 where accuracy is given, or a dx of its own"
        raise ConfigError(f"rate_strengthening: {short_repr(alphas)}; allowed: {allowed}")
    common = {"boundary": simulation["boundary"], "fields": "fields" in simulation["record"]}
    settings = [
        settings_for(
            promise, prestress=profile, gamma=gamma, damping_ratio=ratio, release=release, **common
        )
        for release, profile, gamma, _, ratio, _ in runs(simulation)
    ]
    return {**simulation, "spacings": [found["dx"] for found in settings]}


def _spacings(
    error: float, prestress: Prestress, gamma: float, ratio: float, release: str, fields: bool
) -> list[float]:
    """Spacings that each number allows, with leaf springs or (gamma = 0) under a stress boundary."""
    levels = [prestress.left, prestress.right, *(level for _, level in prestress.steps)]
    peak = min(prestress.width, *(width for *_, width in prestress.bumps), math.inf)
    if gamma:
        nucleation = min(peak, 1.0 / math.sqrt(gamma))
        start = NUCLEATION * (1.0 + ratio) / nucleation
        spacings = [nucleation / BLOCKS, error / start]
        for level in (level for level in levels if level > 0.0):
            speed = speed_of(level, ratio, release)
            # In the limit dx -> 0 damping acts through the speed alone.
            width = pulse_behind_front(level, gamma, 0.0, speed).width
            layer = ratio * speed / ((speed - 1.0) * (speed + 1.0))
            of_speed = math.sqrt(error / (SPEED + SPEED_LAYER * layer * speed))
            spacings += [width / BLOCKS, width * of_speed, error / (start + SLOW_FRONT / width)]
            if fields:
                spacings.append(
                    error * width / max(FRONT_BLOCKS / (level * speed**2), LAYER * layer)
                )
        return spacings
    negative = [level for level in levels if level < 0.0 < prestress.peak]
    reaches = [
        prestress.width * math.sqrt(2.0 * math.log1p(-prestress.peak / level)) for level in negative
    ]
    spacings = [length / BLOCKS for length in (peak, *reaches)]
    if max(levels) > 0.0:
        spacings.append(error * peak / FREE_SPEED)
    if prestress.left < 0.0 == prestress.right and reaches:
        if not prestress.steps:
            spacings.append(error * reaches[0] / (SHARE_TIME + SHARE_TIME_DAMPED * ratio))
        if fields:
            spacings.append(error * reaches[0] / (VELOCITY + VELOCITY_DAMPED * ratio))
    return spacings
