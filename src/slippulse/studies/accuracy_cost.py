"""Error against cost: what each scheme, order, step and spacing buys, and whether a preset could be had cheaper."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from ..lattice.stability import MARGIN, largest_step
from ..measure.fronts import arrival, front_speed, path
from ..measure.pulses import leading_pulse
from ..model import Scene
from ..prestress import Prestress
from ..simulation import simulate
from ..theory.front_speed import front_speed as exact_speed
from ..theory.front_speed import front_speed_undamped
from ..theory.pulse import steady_pulse
from ..theory.rupture import ArrestingCrack, exact_transition_displacement

# Errors of both scenes, relative to exact theory.
QUANTITIES = (
    "front_speed", "peak_velocity", "width", "final_slip", "transition_time", "share_time", "arrest_position", "energy",
)  # fmt: skip
# By which one setting is better than another. The energy balance is a check, not a result, and the arrest is never
# reached in the continuum.
JUDGED = ("front_speed", "peak_velocity", "width", "final_slip", "transition_time", "share_time")
# Errors this close to each other are equal, since what the spacing sets does not depend on the step; so are errors
# below the second.
EQUAL, NEGLIGIBLE = 1.1, 1e-5


def table(settings: Mapping) -> pd.DataFrame:
    """Run the two scenes at every setting, and the textbook scheme against its step.

    Parameters
    ----------
    settings : `studies.accuracy_cost` of the configuration, front_window and presets

    Returns
    -------
    rows of part "trade": scheme, order, step (in units of dx), dx, preset (its name where it is one), work (stencil
    passes over one block), block_updates, one error a quantity, and for presets `dominated_by`; rows of part "locking":
    scheme, step, front_speed, exact

    Source: exact speed, pulse and transitions of `slippulse.theory`, all in the continuum limit at fixed beta/dx.
    """
    window = settings["front_window"]
    theory = exact(settings)
    rows = []
    for scheme, order, step, dx in ladder(settings):
        row = {"scheme": scheme, "order": order, "step": step, "dx": dx}
        # The textbook scheme has no order to choose.
        more = {"scheme": scheme, "order": max(order, 3), "max_step": step}
        rows.append(row | errors(settings, theory, more, dx, window))
    trade = pd.DataFrame(rows)
    trade["preset"] = ""
    for name, preset in settings["presets"].items():
        is_preset = (
            (trade["scheme"] == "localised")
            & np.isclose(trade["dx"], preset["dx"])
            & (trade["order"] == preset["order"])
            & np.isclose(trade["step"], preset["max_step"])
        )
        trade.loc[is_preset, "preset"] = name
    trade["dominated_by"] = [
        dominating(trade, index) if trade["preset"][index] else "" for index in trade.index
    ]
    return pd.concat(
        [trade.assign(part="trade"), locking(settings, window).assign(part="locking")], ignore_index=True
    )


def ladder(settings: Mapping) -> list[tuple[str, int, float, float]]:
    """Every setting: scheme, order, step in units of dx, spacing; presets included."""
    found = [
        ("fixed_step", 1, step, dx)
        for dx in settings["textbook"]["dx"]
        for step in settings["textbook"]["steps"]
    ]
    ratio = settings["damping_ratio"]
    for dx in settings["dx"]:
        for order in settings["orders"]:
            bound = MARGIN * largest_step("localised", order, ratio, settings["gamma"] * dx**2)
            found += [("localised", order, step, dx) for step in settings["steps"] if step <= bound]
    presets = [("localised", p["order"], p["max_step"], p["dx"]) for p in settings["presets"].values()]
    return found + [preset for preset in presets if preset not in found]


def exact(settings: Mapping) -> dict:
    """What both scenes give in the continuum limit."""
    ratio, level = settings["damping_ratio"], settings["level"]
    crack = ArrestingCrack(Prestress(settings["negative_level"], 0.0), ratio)
    return {
        "front_speed": float(exact_speed(level, ratio)),
        "transition_time": exact_transition_displacement(
            Prestress(level, level), settings["gamma"], ratio
        ).time,
        "share_time": crack.share_time(settings["share"]),
        "arrest_position": abs(crack.balance_position),
    }


def errors(settings: Mapping, theory: Mapping, more: Mapping, dx: float, window: float) -> dict:
    """Work and relative errors of the two scenes: a pulse, and the crack that turns into one under held stress."""
    ratio, level, gamma = settings["damping_ratio"], settings["level"], settings["gamma"]
    of = Scene(
        "displacement",
        Prestress(level, level),
        settings["duration"],
        dx,
        gamma=gamma,
        beta=ratio * dx,
        **more,
    )
    run = simulate(of)
    pulse = leading_pulse(run, window)
    steady = steady_pulse(level, gamma, of.beta, theory["front_speed"])
    found = {
        "front_speed": pulse.speed / theory["front_speed"],
        "peak_velocity": pulse.peak_velocity / steady.peak_velocity,
        "width": pulse.width / steady.width,
        "final_slip": pulse.slip / steady.slip,
        "transition_time": run.attrs["first_stick_time"] / theory["transition_time"],
    }
    coarse = settings["stress_scale"] * dx
    profile, duration = (
        Prestress(settings["negative_level"], 0.0),
        settings["stress_duration"] * theory["share_time"],
    )
    stressed = Scene("stress", profile, duration, coarse, beta=ratio * coarse, **more)
    crack = simulate(stressed)
    reach = settings["share"] * theory["arrest_position"]
    found["share_time"] = arrival(crack, reach, "left") / theory["share_time"]
    found["arrest_position"] = path(crack, "left")[1][-1] / theory["arrest_position"]
    out = {name: abs(value - 1.0) for name, value in found.items()}
    out["energy"] = max(run.attrs["energy_residual"], crack.attrs["energy_residual"])
    out["block_updates"] = run.attrs["block_updates"] + crack.attrs["block_updates"]
    out["work"] = sum(work(item) for item in (run, crack))
    return out


def work(run) -> float:
    """Stencil passes over one block: each order is one; the textbook scheme passes once over the whole lattice."""
    if run.attrs["scheme"] == "fixed_step":
        return float(run.attrs["steps"] * run.sizes["x"])
    return float(run.attrs["block_updates"] * run.attrs["order"])


def dominating(trade: pd.DataFrame, index: int) -> str:
    """A setting with less work that is nowhere less accurate and somewhere more; "" when there is none."""
    own = trade.loc[index]
    best, least = "", math.inf
    for other in trade.itertuples():
        if other.work >= own["work"] or other.work >= least:
            continue
        pairs = [(max(getattr(other, name), NEGLIGIBLE), max(own[name], NEGLIGIBLE)) for name in JUDGED]
        nowhere_worse = all(theirs <= EQUAL * ours for theirs, ours in pairs)
        somewhere_better = any(EQUAL * theirs < ours for theirs, ours in pairs)
        if nowhere_worse and somewhere_better:
            best, least = f"order {other.order:g}, step {other.step:g}, dx {other.dx:g}", other.work
    return best


def locking(settings: Mapping, window: float) -> pd.DataFrame:
    """Front speed against the step, both schemes: a crack without damping or leaf springs, at an irrational speed."""
    rule = settings["locking"]
    level = rule["level"]
    rows = []
    for scheme in ("fixed_step", "localised"):
        steps = np.linspace(rule["steps"]["from"], rule["steps"]["to"], rule["steps"]["count"])
        for step in steps if scheme == "fixed_step" else steps[:: rule["every"]]:
            of = Scene(
                "stress",
                Prestress(level, level),
                rule["duration"],
                rule["dx"],
                scheme=scheme,
                max_step=float(step),
            )
            speed, _, _ = front_speed(simulate(of), window)
            rows.append({"scheme": scheme, "step": step, "front_speed": speed})
    return pd.DataFrame(rows).assign(exact=float(front_speed_undamped(level)), dx=rule["dx"])
