"""One edge of the solver's domain: what should happen, what did, and the verdict computed from the two."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import xarray as xr

from ..measure.fronts import front_speed, path
from ..measure.pulses import leading_pulse
from ..model.prestress import Prestress
from ..model.scene import Scene
from ..model.stability import MARGIN, largest_step
from ..predict.measured import pulse_state
from ..simulation.simulate import UnstableRun, simulate
from .outcomes import FLAGGED, NO_NUMBER, NOT_OFFERED, REFUSED, RIGHT, STOPPED, WRONG


@dataclass(frozen=True)
class Measured:
    """What one run gave for one quantity; ``expected`` is NaN where no theory has a value."""

    expected: float
    measured: float
    flags: str = ""
    block_updates: int = 0


@dataclass(frozen=True)
class Edge:
    """One row: a family, the value at its edge, what should happen, and how to find out.

    ``run`` returns what was measured, raises ValueError when the scene is refused and UnstableRun when it is stopped.
    """

    family: str
    value: str
    quantity: str
    should: str
    tolerance: float
    run: Callable[[], Measured]

    def row(self) -> dict:
        """Run it and judge it."""
        out = {
            "family": self.family,
            "value": self.value,
            "quantity": self.quantity,
            "should": self.should,
            "tolerance": self.tolerance,
        }
        nan = float("nan")
        try:
            found = self.run()
        except UnstableRun as error:
            return out | {"verdict": STOPPED, "message": str(error), "block_updates": 0} | _numbers(nan, nan)
        except ValueError as error:
            return out | {"verdict": REFUSED, "message": str(error), "block_updates": 0} | _numbers(nan, nan)
        return (
            out
            | _numbers(found.expected, found.measured)
            | {
                "verdict": verdict(found, self.tolerance),
                "message": found.flags,
                "block_updates": found.block_updates,
            }
        )


def _numbers(expected: float, measured: float) -> dict:
    return {"expected": expected, "measured": measured, "error": error_of(expected, measured)}


def error_of(expected: float, measured: float) -> float:
    """Relative deviation, absolute where 0 is expected."""
    return abs(measured - expected) / (abs(expected) if expected != 0.0 else 1.0)


def verdict(found: Measured, tolerance: float) -> str:
    """A flag wins; then a number that is missing; then the number itself."""
    if found.flags == NOT_OFFERED:
        return NOT_OFFERED
    if found.flags:
        return FLAGGED
    if not np.isfinite(found.measured):
        return NO_NUMBER
    # Comparisons with NaN are False: a number where theory has none is wrong unless it was flagged.
    return RIGHT if error_of(found.expected, found.measured) <= tolerance else WRONG


def stable_step(damping_ratio: float, gamma_dx2: float, order: int = 4, largest: float = 0.5) -> float:
    """The preset's step, or the safe share of the stability bound where that is less."""
    return min(largest, MARGIN * largest_step("localised", order, damping_ratio, gamma_dx2))


def scene(
    prestress: Prestress, gamma: float, damping_ratio: float, dx: float, duration: float, **more
) -> Scene:
    """A scene under the displacement boundary, or under the stress boundary when gamma is 0."""
    boundary = "displacement" if gamma > 0.0 else "stress"
    values = {"max_step": stable_step(damping_ratio, gamma * dx**2)} | more
    return Scene(boundary, prestress, duration, dx, gamma=gamma, beta=damping_ratio * dx, **values)


def flags_of(run: xr.Dataset, window: float) -> str:
    """Flags of the run, and the state of its pulse where that says that steady theory does not apply."""
    state = pulse_state(run, leading_pulse(run, window))
    return ",".join(
        part for part in (run.attrs["run_flags"], state if state not in ("steady", "none") else "") if part
    )


def speed(of: Scene, expected: float, window: float, beyond: float = 0.0) -> Measured:
    """Front speed over the last share of the path, or beyond a distance."""
    run = simulate(of)
    if beyond:
        times, distances = path(run)
        chosen = distances > beyond
        fit = float(np.polyfit(times[chosen], distances[chosen], 1)[0]) if chosen.sum() > 3 else float("nan")
        return Measured(expected, fit, flags_of(run, window), run.attrs["block_updates"])
    return Measured(expected, front_speed(run, window)[0], flags_of(run, window), run.attrs["block_updates"])
