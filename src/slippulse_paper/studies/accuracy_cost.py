"""Compare errors and cost of simulations for each scheme, order, time step and block spacing.

The settings of the presets are among them. The cost is not a time but a number of operations, which
does not depend on the machine. `slippulse_paper.steps.measure_seconds` times the same runs.
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

# Pulses under a displacement boundary, one without damping and one with the damping ratio of the
# paper's figures. Both pulses become steady within the duration.
UNIFORM_PRESTRESS = Prestress(0.55, 0.55)
GAMMA = 0.65
DAMPING_RATIOS = (0.0, 0.1)
DURATION = 20.0
# A crack that turns into a pulse under a stress boundary. The study compares the time at which its
# left front has covered this fraction of its path. The duration is in units of this time.
ARRESTING_PRESTRESS = Prestress(-1.0, 0.0)
COVERED_FRACTION = 0.95
RELATIVE_CRACK_DURATION = 3.0
# The crack is larger than the pulses, so its spacing is larger by this factor.
RELATIVE_CRACK_SPACING = 2.0
# Spacings, orders, and time steps divided by dx, of the localised scheme.
SPACINGS = (0.08, 0.04, 0.02, 0.01, 0.005)
ORDERS = (3, 4, 5, 6, 8)
STEPS = (1.0, 0.5, 0.25)
# Spacings, and time steps divided by dx, of the textbook scheme. Shorter time steps than the
# smallest one are left out, because the runs would take too long.
TEXTBOOK_SPACINGS = (0.04, 0.02, 0.01)
TEXTBOOK_STEPS = (0.5, 0.25, 0.125, 0.0625, 0.03125)
SMALLEST_TEXTBOOK_TIME_STEP = 6.25e-4
# Spacing at which the exact solution is sampled.
EXACT_SPACING = 0.02
# A front whose speed, by theory, is an irrational number, and time steps divided by dx. The
# textbook scheme uses all of these steps, nearly up to its stability bound. The localised scheme
# uses only every fourth one, because its front speed does not depend on the step.
locking_scene = partial(
    Scene, boundary="stress", prestress=Prestress(0.5, 0.5), duration=30.0, dx=0.1
)
LOCKING_STEPS = np.linspace(0.1, 0.98, 67).tolist()

PULSE_QUANTITIES = ("front_speed", "peak_velocity", "width", "final_slip", "transition_time")
# Columns with relative deviations from exact theory, and the residual of the energy balance.
QUANTITIES = (*PULSE_QUANTITIES, "share_time", "arrest_position", "energy")

# The exact solutions are computed once, because they are the same for every setting.
cached_transition = cache(exact_transition_displacement)
cached_crack = cache(ArrestingCrack)
cached_pulse = cache(steady_pulse)


class Setting(NamedTuple):
    """A scheme with its order, its time step divided by dx, and its block spacing dx."""

    scheme: str
    order: int
    step: float
    dx: float

    def run_pulse(self, damping_ratio: float) -> xr.Dataset:
        """Simulate a pulse under a displacement boundary."""
        return self._run(UNIFORM_PRESTRESS, DURATION, gamma=GAMMA, damping_ratio=damping_ratio)

    def run_crack(self) -> xr.Dataset:
        """Simulate a crack that turns into a pulse under a stress boundary.

        The crack is larger than the pulses, so its lattice is coarser than the setting says. The
        run lasts RELATIVE_CRACK_DURATION times as long as the transition.
        """
        # Without damping the ringing of the lattice would move the left front of the crack.
        damping_ratio = max(DAMPING_RATIOS)
        crack = cached_crack(ARRESTING_PRESTRESS, damping_ratio)
        duration = RELATIVE_CRACK_DURATION * crack.transition(COVERED_FRACTION).time
        coarser = self._replace(dx=RELATIVE_CRACK_SPACING * self.dx)
        return coarser._run(ARRESTING_PRESTRESS, duration, gamma=0.0, damping_ratio=damping_ratio)

    def _run(
        self, prestress: Prestress, duration: float, gamma: float, damping_ratio: float
    ) -> xr.Dataset:
        """Simulate a scene with this setting, or with a shorter step if its step is unstable.

        The scene has a displacement boundary, or a stress boundary if ``gamma`` is 0.
        """
        # The textbook scheme and the exact solution do not use the order, but a Scene needs one.
        order = max(self.order, 3)
        stability_limit = largest_step(self.scheme, order, damping_ratio, gamma * self.dx**2)
        scene = Scene(
            boundary="displacement" if gamma > 0.0 else "stress",
            prestress=prestress,
            duration=duration,
            dx=self.dx,
            gamma=gamma,
            beta=damping_ratio * self.dx,
            scheme=self.scheme,
            max_step=min(self.step, STABILITY_MARGIN * stability_limit),
            order=order,
        )
        return simulate(scene)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of two parts of the figure. The column ``part`` has these values:

    trade : one row for each setting, with its cost and its errors
    locking : one row for each scheme and step, with the front speed
    """
    # The front speed is measured over this last fraction of the path.
    front_window = settings["measure"]["front_window"]
    compared = settings_of_schemes()
    preset_name_by_setting: dict[Setting, str] = {}
    for name, preset in settings["presets"].items():
        setting = Setting("localised", preset["order"], preset["max_step"], preset["dx"])
        preset_name_by_setting[setting] = name
        if setting not in compared:
            compared.append(setting)
    errors = [errors_and_cost(setting, front_window) for setting in compared]
    trade_off = pd.DataFrame(compared).join(pd.DataFrame(errors))
    # The name is empty if the setting is that of no preset.
    trade_off["preset"] = [preset_name_by_setting.get(setting, "") for setting in compared]
    trade_off["part"] = "trade"
    return pd.concat([trade_off, locking_rows(front_window)], ignore_index=True)


def settings_of_schemes() -> list[Setting]:
    """Return all settings of the textbook scheme and the localised scheme, and the exact one."""
    compared = []
    for dx, step in product(TEXTBOOK_SPACINGS, TEXTBOOK_STEPS):
        # Runs with smaller time steps would take too long.
        if dx * step >= SMALLEST_TEXTBOOK_TIME_STEP:
            compared.append(Setting(scheme="fixed_step", order=1, step=step, dx=dx))
    for dx, order, step in product(SPACINGS, ORDERS, STEPS):
        compared.append(Setting(scheme="localised", order=order, step=step, dx=dx))
    # The exact solution uses neither the order nor the step.
    compared.append(Setting(scheme="continuum", order=1, step=1.0, dx=EXACT_SPACING))
    return compared


def locking_rows(front_window: float) -> pd.DataFrame:
    """Return the front speed as a function of the time step, for both schemes.

    In the textbook scheme the front speed is wrong and depends on the step, because the front
    advances by one block in a whole number of steps. In the localised scheme it does not depend on
    the step, so fewer steps are enough.

    front_window : last fraction of the path over which the front speed is measured
    """
    schemes_and_steps = [("fixed_step", step) for step in LOCKING_STEPS]
    schemes_and_steps += [("localised", step) for step in LOCKING_STEPS[::4]]
    scenes = [locking_scene(scheme=scheme, max_step=step) for scheme, step in schemes_and_steps]
    rows = pd.DataFrame(schemes_and_steps, columns=["scheme", "step"])
    rows["front_speed"] = [fit_front(simulate(scene), front_window).slope for scene in scenes]
    # The scenes differ only in the scheme and the step.
    exact_speed = front_speed_undamped(scenes[0].prestress.left)
    return rows.assign(exact=exact_speed, dx=scenes[0].dx, part="locking")


def errors_and_cost(setting: Setting, front_window: float) -> dict[str, float]:
    """Return the largest relative error of each quantity, and the total cost of all runs.

    The runs are a pulse for each damping ratio, and a crack that turns into a pulse.

    front_window : last fraction of the path over which the front speed is measured
    """
    runs = [pulse_errors(setting, damping_ratio, front_window) for damping_ratio in DAMPING_RATIOS]
    runs.append(crack_errors(setting))
    row: dict[str, float] = {}
    for quantity in QUANTITIES:
        # Some quantities exist only for pulses, and some only for the crack.
        errors = [run[quantity] for run in runs if quantity in run]
        row[quantity] = float(np.max(errors))
    for cost in ("block_updates", "work"):
        row[cost] = sum(run[cost] for run in runs)
    return row


def pulse_errors(setting: Setting, damping_ratio: float, front_window: float) -> dict[str, float]:
    """Return the relative errors of a simulated pulse, and the cost of its run.

    front_window : last fraction of the path over which the front speed is measured
    """
    run = setting.run_pulse(damping_ratio)
    pulse = leading_pulse(run, front_window)
    # The scheme "continuum" is the limit dx -> 0 at fixed beta/dx, in which beta is 0 and damping
    # only changes the front speed.
    beta = 0.0 if setting.scheme == "continuum" else damping_ratio * setting.dx
    exact = cached_pulse(UNIFORM_PRESTRESS.left, GAMMA, beta, damping_ratio=damping_ratio)
    transition = cached_transition(UNIFORM_PRESTRESS, GAMMA, damping_ratio)
    measured_divided_by_exact = {
        "front_speed": pulse.speed / exact.speed,
        "peak_velocity": pulse.peak_velocity / exact.peak_velocity,
        "width": pulse.width / exact.width,
        "final_slip": pulse.slip / exact.slip,
        "transition_time": run.attrs["first_stick_time"] / transition.time,
    }
    deviations = {name: abs(value - 1.0) for name, value in measured_divided_by_exact.items()}
    return cost_of_run(run) | deviations


def crack_errors(setting: Setting) -> dict[str, float]:
    """Return the relative errors of the left front of a crack, and the cost of its run.

    Exact values are for max(DAMPING_RATIOS), with which `Setting.run_crack` runs the crack.

    The result contains these numbers:

    share_time : error of the time at which the front has covered COVERED_FRACTION of its path
    arrest_position : error of the distance that the front has run at the end
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
    return cost_of_run(run) | deviations


def cost_of_run(run: xr.Dataset) -> dict[str, float]:
    """Return the cost of a run, and the residual of its energy balance.

    The result contains these numbers:

    block_updates : number of sliding blocks, summed over all time steps
    work : number of evaluations of the force on a single block. The textbook scheme evaluates each
        block of the lattice once in each step. The localised scheme evaluates only sliding blocks
        and blocks that an event changes, as many times as its order. NaN for the exact solution.
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
