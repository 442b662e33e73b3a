"""Compare error and cost for each scheme, order, step and spacing, including the presets.

Cost is counted here, not timed: the number of stencil passes over a block does not depend on the
machine. `slippulse_paper.steps.measure_seconds` times the same runs. The exact solution is sampled
at the middle spacing of the textbook scheme.
"""

import math
from functools import cache, partial
from itertools import product
from typing import NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.measurement.front_paths import arrival, fit_front, front_path
from slippulse.measurement.pulses import leading_pulse
from slippulse.model.prestress import Prestress
from slippulse.model.scene import Scene
from slippulse.model.stability import STABILITY_MARGIN, largest_step
from slippulse.simulation.simulate import simulate
from slippulse.theory.arrest import ArrestingCrack
from slippulse.theory.exact_transition import exact_transition_displacement
from slippulse.theory.front_speeds import front_speed_undamped
from slippulse.theory.pulse import steady_pulse

NEEDS = {"settings": ["measure.front_window", "presets"]}

# Two pulses, one without damping and one with that of the paper's figures, become steady.
UNIFORM_PRESTRESS, GAMMA = Prestress(0.55, 0.55), 0.65
DAMPING_RATIOS, DURATION = (0.0, 0.1), 20.0
# A crack turns into a pulse at Gamma = 0. The study compares the time at which its left front has
# covered a fraction of its path; the run lasts three times as long.
ARRESTING_PRESTRESS = Prestress(-1.0, 0.0)
COVERED_FRACTION, CRACK_DURATION = 0.95, 3.0
# The crack is larger than the pulses, so its spacing is larger by this factor.
CRACK_SPACING = 2.0
SPACINGS = (0.08, 0.04, 0.02, 0.01, 0.005)
ORDERS, STEPS = (3, 4, 5, 6, 8), (1.0, 0.5, 0.25)
# The textbook scheme has errors from its step and from the spacing.
TEXTBOOK_SPACINGS, TEXTBOOK_STEPS = (0.04, 0.02, 0.01), (0.5, 0.25, 0.125, 0.0625, 0.03125)
EXACT_SPACING = 0.02
# Front speed as a function of the step, at a level with an irrational speed. The textbook scheme
# uses all steps, nearly up to its stability bound; the localised one only every fourth, because its
# speed does not depend on the step.
locking_scene = partial(Scene, "stress", Prestress(0.5, 0.5), 30.0, 0.1)
LOCKING_STEPS = np.linspace(0.1, 0.98, 67).tolist()

PULSE_QUANTITIES = ("front_speed", "peak_velocity", "width", "final_slip", "transition_time")
# Relative errors compared with exact theory, the largest of all damping ratios.
QUANTITIES = (*PULSE_QUANTITIES, "share_time", "arrest_position", "energy")

# These are the same for every setting.
cached_transition = cache(exact_transition_displacement)
cached_crack = cache(ArrestingCrack)
cached_pulse = cache(steady_pulse)


class Setting(NamedTuple):
    """A scheme with its order, step (in units of dx) and spacing."""

    scheme: str
    order: int
    step: float
    dx: float

    def run_pulse(self, ratio: float) -> xr.Dataset:
        """Simulate a pulse under a displacement boundary with a damping ratio."""
        return self._run(UNIFORM_PRESTRESS, DURATION, GAMMA, ratio)

    def run_crack(self) -> xr.Dataset:
        """Simulate a crack that turns into a pulse under a stress boundary."""
        # It is damped, because otherwise the ringing of the lattice moves its left front.
        ratio = max(DAMPING_RATIOS)
        covered_at = cached_crack(ARRESTING_PRESTRESS, ratio).transition(COVERED_FRACTION).time
        coarser = self._replace(dx=CRACK_SPACING * self.dx)
        return coarser._run(ARRESTING_PRESTRESS, CRACK_DURATION * covered_at, 0.0, ratio)

    def _run(self, profile: Prestress, duration: float, gamma: float, ratio: float) -> xr.Dataset:
        """Simulate a scene, with a shorter step where this one would not be stable."""
        # The textbook scheme and the exact solution have no adjustable order.
        order = max(self.order, 3)
        step = min(
            self.step,
            STABILITY_MARGIN * largest_step(self.scheme, order, ratio, gamma * self.dx**2),
        )
        boundary = "displacement" if gamma > 0.0 else "stress"
        scene = partial(Scene, boundary, profile, duration, self.dx, gamma, ratio * self.dx)
        return simulate(scene(scheme=self.scheme, max_step=step, order=order))


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the parts trade (work and errors of each setting) and locking (speed by step)."""
    presets, window = settings["presets"], settings["measure"]["front_window"]
    names = {
        Setting("localised", preset["order"], preset["max_step"], preset["dx"]): name
        for name, preset in presets.items()
    }
    ladder = []
    for dx, step in product(TEXTBOOK_SPACINGS, TEXTBOOK_STEPS):
        # The smallest steps of the finest lattice would take as long as all other runs.
        if dx * step >= min(TEXTBOOK_STEPS) * EXACT_SPACING:
            ladder.append(Setting("fixed_step", 1, step, dx))
    for dx, order, step in product(SPACINGS, ORDERS, STEPS):
        ladder.append(Setting("localised", order, step, dx))
    ladder.append(Setting("continuum", 1, 1.0, EXACT_SPACING))
    ladder += [setting for setting in names if setting not in ladder]
    rows = [errors(setting, window) for setting in ladder]
    trade = pd.DataFrame(ladder).join(pd.DataFrame(rows))
    trade = trade.assign(preset=[names.get(setting, "") for setting in ladder], part="trade")
    return pd.concat([trade, locking(window)], ignore_index=True)


def locking(window: float) -> pd.DataFrame:
    """Return the front speed as a function of the step, for both schemes."""
    steps = [("fixed_step", step) for step in LOCKING_STEPS]
    steps += [("localised", step) for step in LOCKING_STEPS[::4]]
    rows = pd.DataFrame(steps, columns=["scheme", "step"])
    scenes = [locking_scene(scheme=scheme, max_step=step) for scheme, step in steps]
    rows["front_speed"] = [fit_front(simulate(scene), window)[0] for scene in scenes]
    exact = front_speed_undamped(scenes[0].prestress.left)
    return rows.assign(exact=exact, dx=scenes[0].dx, part="locking")


def errors(setting: Setting, window: float) -> dict[str, float]:
    """Return the work, and the largest relative error of each quantity in pulses and crack."""
    runs = []
    for ratio in DAMPING_RATIOS:
        run = setting.run_pulse(ratio)
        pulse = leading_pulse(run, window)
        # At fixed beta/dx damping acts only at the front in the continuum.
        beta = 0.0 if setting.scheme == "continuum" else ratio * setting.dx
        steady = cached_pulse(UNIFORM_PRESTRESS.left, GAMMA, beta, damping_ratio=ratio)
        names = ("speed", "peak_velocity", "width", "slip")
        ratios = [getattr(pulse, name) / getattr(steady, name) for name in names]
        ratios.append(
            run.attrs["first_stick_time"] / cached_transition(UNIFORM_PRESTRESS, GAMMA, ratio).time
        )
        deviations = np.abs(np.array(ratios) - 1.0)
        runs.append(costs(run) | dict(zip(PULSE_QUANTITIES, deviations, strict=True)))
    crack = cached_crack(ARRESTING_PRESTRESS, max(DAMPING_RATIOS))
    covered_at, distance = crack.transition(COVERED_FRACTION).time, abs(crack.balance_position)
    run = setting.run_crack()
    late = abs(arrival(run, COVERED_FRACTION * distance, "left")[0] / covered_at - 1.0)
    reached = abs(front_path(run, "left")[1][-1] / distance - 1.0)
    runs.append(costs(run) | {"share_time": late, "arrest_position": reached})
    numbers: dict[str, float] = {}
    for name in QUANTITIES:
        numbers[name] = float(np.max([run[name] for run in runs if name in run]))
    numbers["block_updates"] = sum(run["block_updates"] for run in runs)
    return numbers | {"work": sum(run["work"] for run in runs)}


def costs(run: xr.Dataset) -> dict[str, float]:
    """Residual of the energy balance, block updates, and stencil passes over one block.

    Each order is one pass; events have theirs. The textbook scheme passes once over the whole
    lattice, the exact solution has none.
    """
    numbers = run.attrs
    work = {
        "localised": (numbers["block_updates"] + numbers["event_updates"]) * numbers["order"],
        "fixed_step": numbers["steps"] * run.sizes["x"],
        "continuum": math.nan,
    }
    out = {"energy": numbers["energy_residual"], "block_updates": numbers["block_updates"]}
    return out | {"work": float(work[numbers["scheme"]])}
