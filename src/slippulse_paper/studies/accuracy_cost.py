"""Compare error and cost for each scheme, order, step and spacing, including the presets.

Cost is counted here, not timed: the number of stencil passes over a block does not depend on the
machine. `slippulse_paper.steps.measure_seconds` times the same runs.
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
UNIFORM_PRESTRESS = Prestress(0.55, 0.55)
GAMMA = 0.65
DAMPING_RATIOS = (0.0, 0.1)
DURATION = 20.0
# A crack turns into a pulse at Gamma = 0. The study compares the time at which its left front has
# covered a fraction of its path; the run lasts three times as long.
ARRESTING_PRESTRESS = Prestress(-1.0, 0.0)
COVERED_FRACTION = 0.95
RELATIVE_CRACK_DURATION = 3.0
# The crack is larger than the pulses, so its spacing is larger by this factor.
RELATIVE_CRACK_SPACING = 2.0
SPACINGS = (0.08, 0.04, 0.02, 0.01, 0.005)
ORDERS = (3, 4, 5, 6, 8)
STEPS = (1.0, 0.5, 0.25)
# The textbook scheme has errors from its step and from the spacing.
TEXTBOOK_SPACINGS = (0.04, 0.02, 0.01)
TEXTBOOK_STEPS = (0.5, 0.25, 0.125, 0.0625, 0.03125)
# Its time steps are not smaller than this one, because the runs would take too long.
SMALLEST_TEXTBOOK_TIME_STEP = 6.25e-4
# Spacing at which the exact solution is sampled.
EXACT_SPACING = 0.02
# Front speed as a function of the step, at a level with an irrational speed. The textbook scheme
# uses all steps, nearly up to its stability bound; the localised one only every fourth, because its
# speed does not depend on the step.
locking_scene = partial(Scene, "stress", Prestress(0.5, 0.5), 30.0, 0.1)
LOCKING_STEPS = np.linspace(0.1, 0.98, 67).tolist()

PULSE_QUANTITIES = ("front_speed", "peak_velocity", "width", "final_slip", "transition_time")
# Columns with relative errors compared with exact theory, and the residual of the energy balance.
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
        exact_time = cached_crack(ARRESTING_PRESTRESS, ratio).transition(COVERED_FRACTION).time
        coarser = self._replace(dx=RELATIVE_CRACK_SPACING * self.dx)
        return coarser._run(ARRESTING_PRESTRESS, RELATIVE_CRACK_DURATION * exact_time, 0.0, ratio)

    def _run(self, profile: Prestress, duration: float, gamma: float, ratio: float) -> xr.Dataset:
        """Simulate a scene, with a shorter step where this one would not be stable."""
        # The textbook scheme and the exact solution have no adjustable order.
        order = max(self.order, 3)
        stability_limit = largest_step(self.scheme, order, ratio, gamma * self.dx**2)
        scene = Scene(
            boundary="displacement" if gamma > 0.0 else "stress",
            prestress=profile,
            duration=duration,
            dx=self.dx,
            gamma=gamma,
            beta=ratio * self.dx,
            scheme=self.scheme,
            max_step=min(self.step, STABILITY_MARGIN * stability_limit),
            order=order,
        )
        return simulate(scene)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of two parts of the figure, which the column part names.

    trade : one row for each setting, with its work and its errors
    locking : one row for each scheme and step, with the front speed
    """
    presets, window = settings["presets"], settings["measure"]["front_window"]
    preset_names = {
        Setting("localised", preset["order"], preset["max_step"], preset["dx"]): name
        for name, preset in presets.items()
    }
    compared = compared_settings()
    compared += [setting for setting in preset_names if setting not in compared]
    rows = [errors(setting, window) for setting in compared]
    trade = pd.DataFrame(compared).join(pd.DataFrame(rows))
    trade["preset"] = [preset_names.get(setting, "") for setting in compared]
    trade["part"] = "trade"
    return pd.concat([trade, locking(window)], ignore_index=True)


def compared_settings() -> list[Setting]:
    """Return the settings of the textbook scheme, the localised scheme and the exact solution."""
    compared = []
    for dx, step in product(TEXTBOOK_SPACINGS, TEXTBOOK_STEPS):
        if dx * step >= SMALLEST_TEXTBOOK_TIME_STEP:
            compared.append(Setting("fixed_step", 1, step, dx))
    for dx, order, step in product(SPACINGS, ORDERS, STEPS):
        compared.append(Setting("localised", order, step, dx))
    compared.append(Setting("continuum", 1, 1.0, EXACT_SPACING))
    return compared


def locking(window: float) -> pd.DataFrame:
    """Return the front speed as a function of the step, for both schemes.

    In the textbook scheme a front locks onto speeds that depend on the step: it advances by one
    block in a whole number of steps.
    """
    schemes_and_steps = [("fixed_step", step) for step in LOCKING_STEPS]
    schemes_and_steps += [("localised", step) for step in LOCKING_STEPS[::4]]
    scenes = [locking_scene(scheme=scheme, max_step=step) for scheme, step in schemes_and_steps]
    rows = pd.DataFrame(schemes_and_steps, columns=["scheme", "step"])
    rows["front_speed"] = [fit_front(simulate(scene), window).slope for scene in scenes]
    # The scenes differ only in the scheme and the step.
    exact_speed = front_speed_undamped(scenes[0].prestress.left)
    return rows.assign(exact=exact_speed, dx=scenes[0].dx, part="locking")


def errors(setting: Setting, window: float) -> dict[str, float]:
    """Return the work of a setting, and the largest relative error of each quantity in its runs.

    The runs are a pulse for each damping ratio, and a crack that turns into a pulse.
    """
    runs = [pulse_errors(setting, ratio, window) for ratio in DAMPING_RATIOS]
    runs.append(crack_errors(setting))
    row: dict[str, float] = {}
    for quantity in QUANTITIES:
        values = [run[quantity] for run in runs if quantity in run]
        row[quantity] = float(np.max(values))
    row["block_updates"] = sum(run["block_updates"] for run in runs)
    row["work"] = sum(run["work"] for run in runs)
    return row


def pulse_errors(setting: Setting, ratio: float, window: float) -> dict[str, float]:
    """Return the costs of a pulse at one damping ratio, and its relative errors."""
    run = setting.run_pulse(ratio)
    pulse = leading_pulse(run, window)
    # At fixed beta/dx damping acts only at the front in the continuum.
    beta = 0.0 if setting.scheme == "continuum" else ratio * setting.dx
    exact = cached_pulse(UNIFORM_PRESTRESS.left, GAMMA, beta, damping_ratio=ratio)
    transition = cached_transition(UNIFORM_PRESTRESS, GAMMA, ratio)
    measured_over_exact = {
        "front_speed": pulse.speed / exact.speed,
        "peak_velocity": pulse.peak_velocity / exact.peak_velocity,
        "width": pulse.width / exact.width,
        "final_slip": pulse.slip / exact.slip,
        "transition_time": run.attrs["first_stick_time"] / transition.time,
    }
    deviations = {name: abs(value - 1.0) for name, value in measured_over_exact.items()}
    return costs(run) | deviations


def crack_errors(setting: Setting) -> dict[str, float]:
    """Return the costs of the crack, and the relative errors of its left front.

    share_time : time at which the front has covered COVERED_FRACTION of its path
    arrest_position : distance that the front has run at the end
    """
    crack = cached_crack(ARRESTING_PRESTRESS, max(DAMPING_RATIOS))
    exact_time = crack.transition(COVERED_FRACTION).time
    path_length = abs(crack.balance_position)
    run = setting.run_crack()
    time_to_cover, _ = arrival(run, COVERED_FRACTION * path_length, "left")
    _, distances = front_path(run, "left")
    deviations = {
        "share_time": abs(time_to_cover / exact_time - 1.0),
        "arrest_position": abs(distances[-1] / path_length - 1.0),
    }
    return costs(run) | deviations


def costs(run: xr.Dataset) -> dict[str, float]:
    """Return the residual of the energy balance, block updates, and the work.

    The work is the number of stencil passes over one block. In the localised scheme, each order is
    one pass, and events need further ones. The textbook scheme passes once over the whole lattice
    in each step. The exact solution has none, so its work is NaN.
    """
    attrs = run.attrs
    work = {
        "localised": (attrs["block_updates"] + attrs["event_updates"]) * attrs["order"],
        "fixed_step": attrs["steps"] * run.sizes["x"],
        "continuum": math.nan,
    }
    return {
        "energy": attrs["energy_residual"],
        "block_updates": attrs["block_updates"],
        "work": float(work[attrs["scheme"]]),
    }
