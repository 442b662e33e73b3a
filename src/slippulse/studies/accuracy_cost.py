"""Error against cost: what each scheme, order, step and spacing buys, and whether a preset could be had cheaper.

The exact solution stands beside the lattices, sampled at the spacing of the textbook scheme. Seconds are those of the
cost model of `slippulse.configuration.cost`, so that equal inputs give equal tables.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pandas as pd

from ..configuration.cost import expected_seconds
from ..measure.fronts import arrival, front_speed, path
from ..measure.pulses import leading_pulse
from ..model.prestress import Prestress
from ..model.scene import Scene
from ..model.stability import MARGIN, largest_step
from ..simulation.simulate import simulate
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import exact_transition_displacement
from ..theory.front_law import front_speed as exact_speed
from ..theory.front_law import front_speed_undamped
from ..theory.pulse import steady_pulse

# What it is made from besides its own section of `studies`.
NEEDS = {"settings": ["measure.front_window", "presets"]}

# Errors of the scenes, relative to exact theory, the largest over the damping ratios.
QUANTITIES = (
    "front_speed", "peak_velocity", "width", "final_slip", "transition_time", "share_time", "arrest_position", "energy",
)  # fmt: skip
# By which one setting is better than another. The energy balance is a check, not a result, and the arrest is never
# reached in the continuum.
JUDGED = ("front_speed", "peak_velocity", "width", "final_slip", "transition_time", "share_time")
# Errors, and work, this close to each other are equal, since what the spacing sets does not depend on the step; so are
# errors below the second.
EQUAL, NEGLIGIBLE = 1.1, 1e-5


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Run the scenes at every setting, and the textbook scheme against its step.

    Parameters
    ----------
    settings : `studies.accuracy_cost` of the configuration, front_window and presets

    Returns
    -------
    rows of part "trade": scheme, order, step (in units of dx), dx, preset (its name where it is one), work (stencil
    passes over one block), seconds (expected), block_updates, one error a quantity, and for presets `dominated_by`;
    rows of part "locking": scheme, step, front_speed, exact

    Source: exact speed, pulse and transitions of `slippulse.theory`, all in the continuum limit at fixed beta/dx.
    """
    window = settings["measure"]["front_window"]
    theory = exact(settings)
    rows = []
    for scheme, order, step, dx in ladder(settings):
        row = {"scheme": scheme, "order": order, "step": step, "dx": dx}
        rows.append(row | errors(settings, theory, row, window))
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
    found += [
        ("localised", order, step, dx)
        for dx in settings["dx"]
        for order in settings["orders"]
        for step in settings["steps"]
    ]
    found += [("continuum", 1, 1.0, dx) for dx in settings["textbook"]["dx"]]
    presets = [("localised", p["order"], p["max_step"], p["dx"]) for p in settings["presets"].values()]
    return found + [preset for preset in presets if preset not in found]


def exact(settings: Mapping) -> dict:
    """What the scenes give in the continuum limit, by damping ratio."""
    level, share = settings["level"], settings["share"]
    found = {}
    for ratio in settings["damping_ratios"]:
        crack = ArrestingCrack(Prestress(settings["negative_level"], 0.0), ratio)
        transition = exact_transition_displacement(Prestress(level, level), settings["gamma"], ratio)
        found[ratio] = {
            "front_speed": float(exact_speed(level, ratio)),
            "transition_time": transition.time,
            "share_time": crack.share_time(share),
            "arrest_position": abs(crack.balance_position),
        }
    return found


def errors(settings: Mapping, theory: Mapping, row: Mapping, window: float) -> dict:
    """Work of all scenes, and the largest relative error of each quantity over them.

    A pulse at each damping ratio, and at the largest one the crack that turns into a pulse under held stress: without
    damping the ringing of the lattice decides where its left front stands still. The step is cut where it would not be
    stable, as the pipeline does.
    """
    found = []
    for ratio, values in theory.items():
        pulse_scene, crack_scene = scenes(settings, values, row, ratio)
        found.append(pulse_errors(settings, values, pulse_scene, window))
        if ratio == max(theory):
            found.append(crack_errors(settings, values, crack_scene))
    out = {name: float(np.max([entry[name] for entry in found if name in entry])) for name in QUANTITIES}
    return out | {name: sum(entry[name] for entry in found) for name in ("block_updates", "work", "seconds")}


def scenes(settings: Mapping, values: Mapping, row: Mapping, ratio: float) -> tuple[Scene, Scene]:
    """The pulse, and the crack under held stress, of one setting at one damping ratio."""
    level, gamma, dx = settings["level"], settings["gamma"], row["dx"]
    coarse = settings["stress_scale"] * dx
    # The textbook scheme and the exact solution have no order to choose.
    more = {"scheme": row["scheme"], "order": max(row["order"], 3)}

    def step(gamma_dx2: float) -> float:
        if row["scheme"] == "continuum":
            return row["step"]
        return min(row["step"], MARGIN * largest_step(row["scheme"], more["order"], ratio, gamma_dx2))

    pulse = Scene(
        "displacement", Prestress(level, level), settings["duration"], dx, gamma=gamma, beta=ratio * dx,
        max_step=step(gamma * dx**2), **more,
    )  # fmt: skip
    profile, duration = (
        Prestress(settings["negative_level"], 0.0),
        settings["stress_duration"] * values["share_time"],
    )
    crack = Scene("stress", profile, duration, coarse, beta=ratio * coarse, max_step=step(0.0), **more)
    return pulse, crack


def pulse_errors(settings: Mapping, values: Mapping, of: Scene, window: float) -> dict:
    """Relative errors of the pulse and of T_trans, and the work."""
    run = simulate(of)
    pulse = leading_pulse(run, window)
    # At fixed beta/dx damping acts at the front alone in the continuum.
    beta = 0.0 if of.scheme == "continuum" else of.beta
    steady = steady_pulse(settings["level"], settings["gamma"], beta, values["front_speed"])
    return {
        "front_speed": abs(pulse.speed / values["front_speed"] - 1.0),
        "peak_velocity": abs(pulse.peak_velocity / steady.peak_velocity - 1.0),
        "width": abs(pulse.width / steady.width - 1.0),
        "final_slip": abs(pulse.slip / steady.slip - 1.0),
        "transition_time": abs(run.attrs["first_stick_time"] / values["transition_time"] - 1.0),
        "energy": run.attrs["energy_residual"],
        "block_updates": run.attrs["block_updates"],
        "work": work(run),
        "seconds": expected_seconds(of),
    }


def crack_errors(settings: Mapping, values: Mapping, of: Scene) -> dict:
    """Relative errors of the left front, and the work."""
    run = simulate(of)
    reached = arrival(run, settings["share"] * values["arrest_position"], "left")
    return {
        "share_time": abs(reached / values["share_time"] - 1.0),
        "arrest_position": abs(path(run, "left")[1][-1] / values["arrest_position"] - 1.0),
        "energy": run.attrs["energy_residual"],
        "block_updates": run.attrs["block_updates"],
        "work": work(run),
        "seconds": expected_seconds(of),
    }


def work(run) -> float:
    """Stencil passes over one block, those of events included: each order is one; the textbook scheme passes once over
    the whole lattice, the exact solution has none.
    """
    if run.attrs["scheme"] == "continuum":
        return math.nan
    if run.attrs["scheme"] == "fixed_step":
        return float(run.attrs["steps"] * run.sizes["x"])
    return float((run.attrs["block_updates"] + run.attrs["event_updates"]) * run.attrs["order"])


def dominating(trade: pd.DataFrame, index: int) -> str:
    """A setting of a lattice with less work that is nowhere less accurate and somewhere more; "" when there is none."""
    own = trade.loc[index]
    best, least = "", math.inf
    for other in trade[trade["scheme"] != "continuum"].itertuples():
        if EQUAL * other.work > own["work"] or other.work >= least:
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
