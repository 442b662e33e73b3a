"""Error against cost: what each scheme, order, step and spacing buys, the presets among them.

Cost is counted, not timed: passes of the stencil over a block do not depend on the machine. The exact solution is
sampled at the spacing of the textbook scheme.
"""

import math
from functools import cache
from itertools import product

import numpy as np
import pandas as pd
import xarray as xr

from ..measure.fronts import arrival, front_speed, path
from ..measure.pulses import leading_pulse
from ..model.prestress import Prestress
from ..model.scene import Scene
from ..model.stability import MARGIN, largest_step
from ..simulation.simulate import simulate
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import exact_transition_displacement
from ..theory.front_speeds import front_speed as exact_speed
from ..theory.front_speeds import front_speed_undamped, steady_pulse

NEEDS = {"settings": ["measure.front_window", "presets"]}

# Two pulses, without damping and with that of the paper's figures, long enough to be steady.
EVEN, GAMMA, DAMPING_RATIOS, DURATION = Prestress(0.55, 0.55), 0.65, (0.0, 0.1), 20.0
# A crack that turns into a pulse at Gamma = 0, the fraction of the way of its left front whose time is compared, its
# duration in units of that time, and its spacing over that of the pulses, since it is larger.
UNEVEN, FRACTION, CRACK_DURATION, CRACK_SPACING = Prestress(-1.0, 0.0), 0.95, 3.0, 2.0
# Every setting; the presets are added. The error of the textbook scheme is that of its step: one spacing is enough.
SPACINGS, ORDERS, STEPS = (0.08, 0.04, 0.02, 0.01, 0.005), (3, 4, 5, 6, 8), (1.0, 0.5, 0.25)
TEXTBOOK_SPACING, TEXTBOOK_STEPS = 0.02, (0.5, 0.25, 0.125, 0.0625, 0.03125)
# Front speed against the step, at a level with an irrational speed: the textbook scheme nearly up to its stability
# bound, the localised one, which does not depend on it, at some of these steps.
LOCKING, LOCKING_SPACING, LOCKING_DURATION = Prestress(0.5, 0.5), 0.1, 30.0
LOCKING_STEPS, EVERY = np.linspace(0.1, 0.98, 67).tolist(), 4

# Errors of the scenes, relative to exact theory, the largest over the damping ratios.
QUANTITIES = (
    "front_speed", "peak_velocity", "width", "final_slip", "transition_time", "share_time", "arrest_position", "energy",
)  # fmt: skip


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Rows of part "trade": scheme, order, step (in units of dx), dx, preset (its name where it is one), work (stencil
    passes over one block), block_updates and one error a quantity; of part "locking": scheme, step, front_speed, exact.
    Exact is the continuum limit at fixed beta/dx.
    """
    window = settings["measure"]["front_window"]
    given = settings["presets"].items()
    presets = {
        ("localised", preset["order"], preset["max_step"], preset["dx"]): name
        for name, preset in given
    }
    ladder = [("fixed_step", 1, step, TEXTBOOK_SPACING) for step in TEXTBOOK_STEPS]
    ladder += [
        ("localised", order, step, dx) for dx, order, step in product(SPACINGS, ORDERS, STEPS)
    ]
    ladder += [("continuum", 1, 1.0, TEXTBOOK_SPACING)]
    ladder += [setting for setting in presets if setting not in ladder]
    trade = pd.DataFrame(ladder, columns=["scheme", "order", "step", "dx"])
    trade = trade.join(pd.DataFrame([errors(*setting, window) for setting in ladder]))
    trade = trade.assign(preset=[presets.get(setting, "") for setting in ladder], part="trade")
    steps = [("fixed_step", step) for step in LOCKING_STEPS]
    steps += [("localised", step) for step in LOCKING_STEPS[::EVERY]]
    locking, of = [], ("stress", LOCKING, LOCKING_DURATION, LOCKING_SPACING)
    for scheme, step in steps:
        speed = front_speed(simulate(Scene(*of, scheme=scheme, max_step=step)), window)[0]
        locking.append({"scheme": scheme, "step": step, "front_speed": speed})
    exact = {"exact": front_speed_undamped(LOCKING.left), "dx": LOCKING_SPACING, "part": "locking"}
    return pd.concat([trade, pd.DataFrame(locking).assign(**exact)], ignore_index=True)


# The same for every setting.
transition_of, crack_of = cache(exact_transition_displacement), cache(ArrestingCrack)
speed_of = cache(exact_speed)


def errors(scheme: str, order: int, step: float, dx: float, window: float) -> dict[str, float]:
    """Work, and the largest relative error of each quantity, over a pulse at each damping ratio, and at the largest one
    the crack: without damping the ringing of the lattice decides where its left front stands still.
    """
    # The textbook scheme and the exact solution have no order to choose.
    known = max(order, 3)

    def run(
        profile: Prestress, duration: float, dx: float, gamma: float, ratio: float
    ) -> xr.Dataset:
        # The step is cut where it would not be stable, as the pipeline does.
        bound = MARGIN * largest_step(scheme, known, ratio, gamma * dx**2)
        of = ("displacement" if gamma > 0.0 else "stress", profile, duration, dx, gamma, ratio * dx)
        return simulate(Scene(*of, scheme=scheme, max_step=min(step, bound), order=known))

    found = []
    for ratio in DAMPING_RATIOS:
        data = run(EVEN, DURATION, dx, GAMMA, ratio)
        pulse, speed = leading_pulse(data, window), float(speed_of(EVEN.left, ratio))
        # At fixed beta/dx damping acts at the front alone in the continuum.
        steady = steady_pulse(EVEN.left, GAMMA, 0.0 if scheme == "continuum" else ratio * dx, speed)
        names = ("speed", "peak_velocity", "width", "slip")
        ratios = [getattr(pulse, name) / getattr(steady, name) for name in names]
        ratios.append(data.attrs["first_stick_time"] / transition_of(EVEN, GAMMA, ratio).time)
        found.append(
            costs(data) | dict(zip(QUANTITIES, np.abs(np.array(ratios) - 1.0), strict=False))
        )
    crack = crack_of(UNEVEN, max(DAMPING_RATIOS))
    time, distance = crack.time_at_fraction(FRACTION), abs(crack.balance_position)
    data = run(UNEVEN, CRACK_DURATION * time, CRACK_SPACING * dx, 0.0, max(DAMPING_RATIOS))
    late, short = (
        arrival(data, FRACTION * distance, "left")[0] / time,
        path(data, "left")[1][-1] / distance,
    )
    found.append(costs(data) | {"share_time": abs(late - 1.0), "arrest_position": abs(short - 1.0)})
    out = {
        name: float(np.max([entry[name] for entry in found if name in entry]))
        for name in QUANTITIES
    }
    return out | {name: sum(entry[name] for entry in found) for name in ("block_updates", "work")}


def costs(run: xr.Dataset) -> dict[str, float]:
    """Residual of the energy balance, block updates, and stencil passes over one block, those of events included.

    Each order is one pass; the textbook scheme passes once over the whole lattice, the exact solution has none.
    """
    numbers = run.attrs
    work = {
        "localised": (numbers["block_updates"] + numbers["event_updates"]) * numbers["order"],
        "fixed_step": numbers["steps"] * run.sizes["x"],
        "continuum": math.nan,
    }
    found = {"energy": numbers["energy_residual"], "block_updates": numbers["block_updates"]}
    return found | {"work": float(work[numbers["scheme"]])}
