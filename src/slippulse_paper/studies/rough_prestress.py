"""Ensembles of pulses on a rough pre-stress: how far they run, and the slip they leave behind."""

from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.data.points import Recorded, runs_in
from slippulse.model.rough_prestress import rough
from slippulse.theory.front_speeds import front_speed
from slippulse.theory.pulse import steady_pulse

from ..configuration.profiles import prestress_of
from .rough_theory import (
    balance_position,
    barrier_rate,
    diffusivity,
    first_passage,
)
from .survival_statistics import (
    Fate,
    death_rate,
    survival,
    survival_exponent,
)

NEEDS = {
    "data": ["rough_displacement", "rough_settling", "rough_stress"],
    "sweeps": ["rough_displacement", "rough_settling", "rough_stress"],
}

# Keys of a rough profile that all runs of an ensemble have in common.
KEYS = ("level", "deviation", "correlation_length", "hurst", "spacing", "stop")
# Pulses are followed from here on, farther than their nucleation reaches.
START = 5.0
# Levels at which front speeds are computed, for interpolation.
SPEED_LEVELS = np.linspace(0.01, 0.95, 95)
# Positions to which the pre-stress is integrated, beyond every pulse and its beginning.
FINE = 0.05
MIDDLES = FINE * (np.arange(-600, 3200) + 0.5)
# Further seeds whose deaths are found without a simulation, up to a distance, from fields of a
# coarser spacing. The exponent of survival is that beyond ASYMPTOTE, many death scales.
FIRST_SEED, LONG_SEEDS, LONG, LONG_SPACING, ASYMPTOTE = 1001, 500, 2000.0, 0.5, 200.0
# Every so many steps of the long curve of survival are kept.
LONG_STEP = 5


class Ensemble(NamedTuple):
    """Runs that differ in their seed alone, with the parameters that they have in common."""

    keys: dict[str, Any]
    runs: list[Recorded]
    profiles: list[dict]


def table(data: Mapping[str, xr.Dataset], tables: dict, settings: dict) -> pd.DataFrame:
    """Parts ensemble and survival; with the stress held pulse, long and long_survival, too."""
    sweeps = settings["sweeps"]
    groups = [
        group for name in NEEDS["data"] for group in ensembles(data[name], sweeps[name]["profiles"])
    ]
    held = [group for group in groups if group.keys["boundary"] == "displacement"]
    stress = [group for group in groups if group.keys["boundary"] == "stress"]
    (reference,) = (group for group in stress if not group.keys["deviation"])
    total = integral(reference.profiles[0])
    # Twice the largest velocity of the pulse.
    push = total[-1] - total[MIDDLES < 0.0].min()
    parts = [held_displacement(group) for group in held]
    parts.append(long_walks(stress[0], reference.profiles[0]))
    parts += [held_stress(group, push) for group in stress if group.keys["deviation"]]
    return pd.concat(parts, ignore_index=True)


def ensembles(data: xr.Dataset, profiles: list[dict]) -> Iterator[Ensemble]:
    """Yield the ensembles of a sweep, each with the runs of its seeds."""
    groups: dict[tuple, Ensemble] = {}
    for run, profile in zip(runs_in(data), profiles, strict=True):
        rough = {key: profile["rough"][key] for key in KEYS}
        keys = {name: run.attrs[name] for name in ("boundary", "gamma", "damping_ratio", "dx")}
        group = groups.setdefault(tuple(rough.values()), Ensemble(keys | rough, [], []))
        group.runs.append(run)
        group.profiles.append(profile)
    yield from groups.values()


def fate(run: Recorded, side: int, stop: float) -> Fate:
    """Return how far the pulse on one side (1 or -1) has gone, and whether all of it has stuck.

    A pulse is no longer followed where the rough pre-stress stops.
    """
    ahead = (side * run["x"] > 0.0) & np.isfinite(run["release_time"])
    # Rounded, equal distances stay equal on both sides.
    distance = round(float(np.max(side * run["x"][ahead], initial=0.0)), 9)
    died = bool(np.isfinite(run["stick_time"][ahead]).all())
    return Fate(min(distance, stop), died and distance < stop)


def held_displacement(group: Ensemble) -> pd.DataFrame:
    """Deaths against the rate of barriers, survival, and the local state where slip is recorded."""
    stop = group.keys["stop"]
    fates = [fate(run, side, stop) for run in group.runs for side in (1, -1)]
    row = {"part": "ensemble"} | death_rate(fates, START) | barrier_rate(group.keys)
    if "slip" in group.runs[0]:
        row |= local_state(group)
    parts = [pd.DataFrame([row]), survival(fates).assign(part="survival")]
    return pd.concat(parts).assign(**group.keys)


def local_state(group: Ensemble) -> dict[str, float]:
    """Final slip and front speed against steady pulses at the local and at the mean pre-stress."""
    level, ratio = group.keys["level"], group.keys["damping_ratio"]
    pulse = steady_pulse(level, group.keys["gamma"], damping_ratio=ratio)
    memory = pulse.width / (pulse.speed - 1.0)
    slowness_at_levels = 1.0 / front_speed(SPEED_LEVELS, ratio)
    slips, levels, times, exact_times = [], [], [], []
    for run in group.runs:
        settled = (run["x"] > memory) & np.isfinite(run["stick_time"])
        slips.append(run["slip"][settled] / pulse.slip)
        levels.append(run["prestress"][settled] / level)
        passed = (run["x"] > START) & np.isfinite(run["release_time"])
        release = run["release_time"][passed]
        distance = np.ptp(run["x"][passed])
        times.append((release[-1] - release[0]) / distance)
        slowness = np.interp(run["prestress"][passed], SPEED_LEVELS, slowness_at_levels)
        exact_times.append(np.mean(slowness))
    slip, relative_level = np.concatenate(slips), np.concatenate(levels)
    return {
        "pulse_width": pulse.width,
        "memory": memory,
        # Median distance from the steady slip at the local pre-stress, and at the mean one.
        "off_local": float(np.median(np.abs(slip / relative_level - 1.0))),
        "off_mean": float(np.median(np.abs(slip - 1.0))),
        "slip_mean": float(np.mean(slip)),
        "slip_deviation": float(np.std(slip)),
        "slowness": float(np.mean(times) * pulse.speed),
        "slowness_off": float(np.max(np.abs(np.divide(times, exact_times) - 1.0))),
    }


def held_stress(group: Ensemble, push: float) -> pd.DataFrame:
    """Deaths and velocities against the integral of the pre-stress of each run, and survival."""
    fates = [fate(run, 1, group.keys["stop"]) for run in group.runs]
    pulses = pd.DataFrame(fates).assign(part="pulse")
    integrals = [integral(profile) for profile in group.profiles]
    pulses["balance"] = [balance_position(MIDDLES, total) for total in integrals]
    states = [end_state(run, total) for run, total in zip(group.runs, integrals, strict=True)]
    pulses = pulses.join(pd.DataFrame(states))
    row = {"part": "ensemble"} | death_rate(fates, START)
    at_start = int(np.searchsorted(MIDDLES, START))
    pushes = np.array([push_at(total, at_start) for total in integrals])
    rate = diffusivity(group.keys)
    row |= {"push": push, "diffusivity": rate, "death_scale": float(np.mean(pushes)) ** 2 / rate}
    curve = survival(fates).assign(part="survival")
    walked = np.maximum(curve["distance"].to_numpy() - START, FINE)[:, np.newaxis]
    walks = first_passage(walked, pushes, group.keys)
    curve["predicted"] = np.mean(walks, axis=1)
    row |= curve[["survival", "low", "high", "predicted"]].iloc[-1].to_dict()
    alive = pulses[~pulses["died"]]
    row |= {
        "cracks": int(alive["is_crack"].sum()),
        "velocity_mean": alive["velocity"].mean(),
        "velocity_deviation": alive["velocity"].std(),
        "velocity_predicted": 0.5 * np.sqrt(rate * alive["distance"].mean()),
        "velocity_off": (alive["velocity"] - alive["exact_velocity"]).abs().median(),
    }
    return pd.concat([pd.DataFrame([row]), pulses, curve]).assign(**group.keys)


def push_at(total: np.ndarray, index: int) -> float:
    """Integral of the pre-stress from x_* to one of MIDDLES."""
    return float(total[index] - total[MIDDLES < 0.0].min())


def long_walks(group: Ensemble, smooth: dict) -> pd.DataFrame:
    """Survival of further seeds over a long distance, by the balance of the pre-stress alone."""
    rough_keys = group.profiles[0]["rough"] | {"spacing": LONG_SPACING, "stop": LONG}
    x = rough_keys["start"] + LONG_SPACING * np.arange(
        round((LONG - rough_keys["start"]) / LONG_SPACING) + 1
    )
    # The Gaussian at x = 0 takes the place of the background.
    background, peak = -np.expm1(-0.5 * (x / smooth["width"]) ** 2), prestress_of(smooth)(x)
    fates = []
    for seed in range(LONG_SEEDS):
        field = rough(**rough_keys | {"seed": FIRST_SEED + seed}).tau
        at = balance_position(x, LONG_SPACING * np.cumsum(field * background + peak))
        fates.append(Fate(min(at, LONG), bool(at < LONG)))
    row = {"part": "long"} | death_rate(fates, START) | survival_exponent(fates, ASYMPTOTE)
    curve = survival(fates).iloc[::LONG_STEP].assign(part="long_survival")
    return pd.concat([pd.DataFrame([row]), curve]).assign(**group.keys)


def end_state(run: Recorded, total: np.ndarray) -> dict[str, float]:
    """Velocity of the pulse at the end of its run, that by theory, and whether it is a crack.

    The wave that began at x_* carries the largest velocity. By theory this is half of the integral
    of the pre-stress from x_* to where the wave that it meets has left the right front.
    """
    x, release, end = run["x"], run["release_time"], run.attrs["end_time"]
    before = MIDDLES < 0.0
    start = float(MIDDLES[before][np.argmin(total[before])])
    crest = start + end - float(np.interp(start, x, np.nan_to_num(release, nan=end)))
    ahead = (x > 0.0) & np.isfinite(release)
    left_front = float(np.interp(crest + end, x[ahead] + release[ahead], x[ahead]))
    gained = float(np.interp(left_front, MIDDLES, total) - total[before].min())
    near = np.isnan(run["stick_time"][np.searchsorted(x, START)])
    return {
        "velocity": float(np.interp(crest, x, run["slip_velocity"])),
        "exact_velocity": 0.5 * gained,
        "is_crack": bool(near),
    }


def integral(profile: Mapping[str, Any]) -> np.ndarray:
    """Integral of the pre-stress of a profile up to MIDDLES."""
    return FINE * np.cumsum(prestress_of(profile)(MIDDLES))
