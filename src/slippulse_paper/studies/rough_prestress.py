"""Measure how far pulses run on a rough pre-stress, and the slip that they leave behind.

An ensemble is a set of runs whose pre-stress is drawn from the same random field with different
seeds. Under a displacement boundary, pulses run to both sides, and their deaths are compared with
the rate of fatal barriers.

Under a stress boundary, only the right pulse runs on. The push of this pulse is the integral of the
pre-stress from x_*, where the left front stopped, to the pulse. As the pulse advances, its push
makes a random walk, and the pulse dies where the push has fallen to 0 (`rough_theory`).
"""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import xarray as xr

from slippulse.data.points import Recorded, runs_in
from slippulse.model.rough_prestress import rough
from slippulse.theory.closed_pulse import SteadyPulse
from slippulse.theory.front_speeds import front_speed
from slippulse.theory.pulse import steady_pulse

from ..configuration.profiles import ExpandedProfiles, prestress_of
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

# Keys of a rough profile and attributes of a run that all runs of an ensemble have in common.
ROUGH_KEYS = ("level", "deviation", "correlation_length", "hurst", "spacing", "stop")
RUN_KEYS = ("boundary", "gamma", "damping_ratio", "dx")
# Pulses are counted from here on, which is beyond the region that the nucleation reaches.
START = 5.0
# Levels at which front speeds are computed; between them the slowness is interpolated.
SPEED_LEVELS = np.linspace(0.01, 0.95, 95)
# The pre-stress is integrated over cells of this width, whose middles cover every pulse and x_*.
CELL_WIDTH = 0.05
CELL_MIDDLES = CELL_WIDTH * (np.arange(-600, 3200) + 0.5)
# Additional pulses are followed over a long distance by the balance of the pre-stress, without a
# simulation: first seed, number of seeds, distance, and grid spacing of their fields.
FIRST_LONG_SEED = 1001
LONG_SEEDS = 500
LONG_DISTANCE = 2000.0
LONG_SPACING = 0.5
# The exponent of survival is fitted beyond this distance, which is many death scales.
ASYMPTOTIC_DISTANCE = 200.0
# The table has every fifth row of the long survival curve.
LONG_CURVE_STEP = 5


class Ensemble(NamedTuple):
    """Runs whose pre-stress fields differ only in their seed.

    parameters : what all runs have in common, by the names in RUN_KEYS and ROUGH_KEYS
    release : release rule of all runs
    runs : one simulated run for each seed
    profiles : the pre-stress profile of each run, as in the configuration
    """

    parameters: dict[str, Any]
    release: str
    runs: list[Recorded]
    profiles: list[dict]


def table(data: Mapping[str, xr.Dataset], tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of all parts of the study. The column ``part`` has these values:

    ensemble : one row for each ensemble, with its death rate and its other numbers
    survival : the survival curve of each ensemble, one row for each distance
    pulse : one row for each run under a stress boundary
    long, long_survival : the same as ensemble and survival, over LONG_DISTANCE without a simulation
    """
    ensembles: list[Ensemble] = []
    for name in NEEDS["data"]:
        profiles = ExpandedProfiles(settings["sweeps"][name]["profiles"])
        ensembles += ensembles_of(data[name], profiles)
    by_boundary: dict[str, list[Ensemble]] = {"displacement": [], "stress": []}
    for ensemble in ensembles:
        by_boundary[ensemble.parameters["boundary"]].append(ensemble)
    parts = [displacement_rows(ensemble) for ensemble in by_boundary["displacement"]]

    under_stress = by_boundary["stress"]
    # One of the ensembles has no roughness.
    (smooth,) = (ensemble for ensemble in under_stress if ensemble.parameters["deviation"] == 0.0)
    smooth_profile = smooth.profiles[0]
    # The push that a pulse has far away if there is no roughness.
    smooth_push = push_at(prestress_integral(smooth_profile), CELL_MIDDLES.size - 1)
    # More pulses with the roughness of the first ensemble are followed over a long distance.
    parts.append(long_distance_rows(under_stress[0], smooth_profile))
    for ensemble in under_stress:
        if ensemble is not smooth:
            parts.append(stress_rows(ensemble, smooth_push))
    return pd.concat(parts, ignore_index=True)


def ensembles_of(data: xr.Dataset, profiles: Iterable[dict]) -> Iterator[Ensemble]:
    """Yield the ensembles of a sweep. The runs of an ensemble differ only in the seed.

    profiles : the pre-stress profile of each run
    """
    ensembles: dict[tuple, Ensemble] = {}
    for run, profile in zip(runs_in(data), profiles, strict=True):
        run_parameters = {name: run.attrs[name] for name in RUN_KEYS}
        rough_parameters = {name: profile["rough"][name] for name in ROUGH_KEYS}
        key = tuple(rough_parameters.values())
        if key not in ensembles:
            parameters = run_parameters | rough_parameters
            ensembles[key] = Ensemble(parameters, run.attrs["release"], runs=[], profiles=[])
        ensembles[key].runs.append(run)
        ensembles[key].profiles.append(profile)
    yield from ensembles.values()


def fate_of_pulse(run: Recorded, side: int, stop: float) -> Fate:
    """Return how far the pulse on one side of x = 0 has gone, and whether it died there.

    The pulse has gone as far as the outermost block that was released. It has died if all released
    blocks have stuck again.

    side : 1 for the right side, -1 for the left
    stop : distance at which the rough pre-stress ends; a pulse that gets there counts as alive
    """
    distances = side * run["x"]
    released = (distances > 0.0) & np.isfinite(run["release_time"])
    farthest = float(np.max(distances[released], initial=0.0))
    # After rounding, distances that should be equal on both sides are equal.
    distance = round(farthest, 9)
    all_stuck = bool(np.isfinite(run["stick_time"][released]).all())
    return Fate(min(distance, stop), died=all_stuck and distance < stop)


def displacement_rows(ensemble: Ensemble) -> pd.DataFrame:
    """Return the rows of one ensemble under a displacement boundary.

    The row of the part ensemble has the death rate and the predicted rate of fatal barriers. If
    slip was recorded, it also compares slip and front speed with those of steady pulses. The part
    survival has one curve for the pulses of both sides.
    """
    # The distance at which the rough pre-stress ends.
    stop = ensemble.parameters["stop"]
    fates = []
    for run in ensemble.runs:
        fates += [fate_of_pulse(run, side, stop) for side in (1, -1)]
    # Deaths are counted from START on, which is beyond the region that the nucleation reaches.
    row = {"part": "ensemble"} | death_rate(fates, START)
    row |= barrier_rate(ensemble.parameters, ensemble.release)
    if "slip" in ensemble.runs[0]:
        row |= steady_pulse_comparison(ensemble)
    curve = survival(fates).assign(part="survival")
    return pd.concat([pd.DataFrame([row]), curve]).assign(**ensemble.parameters)


def steady_pulse_comparison(ensemble: Ensemble) -> dict[str, float]:
    """Compare final slip and front speed with steady pulses at the local and the mean pre-stress.

    Slip and speed are divided by those of the steady pulse at the mean pre-stress.
    """
    parameters = ensemble.parameters
    pulse = steady_pulse(
        parameters["level"],
        parameters["gamma"],
        damping_ratio=parameters["damping_ratio"],
        release=ensemble.release,
    )
    # A pulse forgets what it met after this distance.
    memory = pulse.width / (pulse.speed - 1.0)
    numbers = {"pulse_width": pulse.width, "memory": memory}
    return numbers | slip_numbers(ensemble, pulse, memory) | slowness_numbers(ensemble, pulse)


def slip_numbers(ensemble: Ensemble, pulse: SteadyPulse, memory: float) -> dict[str, float]:
    """Compare the final slip of all blocks of an ensemble with steady slip.

    The columns off_local and off_mean have the median deviations from the slip of steady pulses at
    the local and at the mean pre-stress. Steady slip is proportional to the pre-stress.

    pulse : the steady pulse at the mean pre-stress
    memory : blocks are compared beyond this position, where the nucleation is forgotten
    """
    slips, levels = [], []
    for run in ensemble.runs:
        is_compared = (run["x"] > memory) & np.isfinite(run["stick_time"])
        slips.append(run["slip"][is_compared])
        levels.append(run["prestress"][is_compared])
    relative_slip = np.concatenate(slips) / pulse.slip
    relative_level = np.concatenate(levels) / ensemble.parameters["level"]
    return {
        "off_local": float(np.median(np.abs(relative_slip / relative_level - 1.0))),
        "off_mean": float(np.median(np.abs(relative_slip - 1.0))),
        "slip_mean": float(np.mean(relative_slip)),
        "slip_deviation": float(np.std(relative_slip)),
    }


def slowness_numbers(ensemble: Ensemble, pulse: SteadyPulse) -> dict[str, float]:
    """Compare the slowness of fronts (time per distance) with that of steady fronts.

    The result contains these numbers:

    slowness : mean over all runs, divided by the slowness of the steady pulse
    slowness_off : largest relative deviation of a run from the slowness that theory predicts, which
        is the mean over all blocks of the slowness of a steady front at the local pre-stress

    The argument ``pulse`` is the steady pulse at the mean pre-stress.
    """
    damping_ratio = ensemble.parameters["damping_ratio"]
    slownesses_at_levels = 1.0 / front_speed(SPEED_LEVELS, damping_ratio, ensemble.release)
    slownesses, predicted_slownesses = [], []
    for run in ensemble.runs:
        # Blocks up to START are left out, because the nucleation changes the front speed there.
        is_passed = (run["x"] > START) & np.isfinite(run["release_time"])
        x, times = run["x"][is_passed], run["release_time"][is_passed]
        slownesses.append((times[-1] - times[0]) / np.ptp(x))
        predicted_at_blocks = np.interp(
            run["prestress"][is_passed], SPEED_LEVELS, slownesses_at_levels
        )
        predicted_slownesses.append(np.mean(predicted_at_blocks))
    ratios = np.divide(slownesses, predicted_slownesses)
    return {
        "slowness": float(np.mean(slownesses) * pulse.speed),
        "slowness_off": float(np.max(np.abs(ratios - 1.0))),
    }


def stress_rows(ensemble: Ensemble, smooth_push: float) -> pd.DataFrame:
    """Return the rows of one ensemble under a stress boundary: ensemble, pulse and survival.

    Only the right pulse counts. Its death and its velocity are compared with the integral of the
    pre-stress of its own run. The survival curve is compared with that of a random walk.

    smooth_push : push that a pulse has far away if there is no roughness, for the column push
    """
    parameters = ensemble.parameters
    cell_of_start = int(np.searchsorted(CELL_MIDDLES, START))
    fates: list[Fate] = []
    pulse_rows, pushes_at_start = [], []
    for run, profile in zip(ensemble.runs, ensemble.profiles, strict=True):
        integral = prestress_integral(profile)
        fate = fate_of_pulse(run, side=1, stop=parameters["stop"])
        row = fate._asdict() | {"part": "pulse"}
        row["balance"] = balance_position(CELL_MIDDLES, integral)
        pulse_rows.append(row | end_state(run, integral))
        fates.append(fate)
        pushes_at_start.append(push_at(integral, cell_of_start))
    pulses, pushes = pd.DataFrame(pulse_rows), np.array(pushes_at_start)

    # Part survival. The random walk of each pulse begins with its push at START.
    curve = survival(fates).assign(part="survival")
    curve["predicted"] = predicted_survival(curve["distance"].to_numpy(), pushes, parameters)

    # Part ensemble, a single row. The diffusivity is the variance of the push per distance.
    variance_rate = diffusivity(parameters)
    numbers = {"part": "ensemble"} | death_rate(fates, START)
    # Distance over which the random walk of the push spreads by the mean push at START.
    death_scale = float(np.mean(pushes)) ** 2 / variance_rate
    numbers |= {"push": smooth_push, "diffusivity": variance_rate, "death_scale": death_scale}
    # Survival at the largest distance.
    numbers |= curve[["survival", "low", "high", "predicted"]].iloc[-1].to_dict()
    # Only pulses that are alive have a velocity at the end.
    numbers |= velocity_numbers(pulses[~pulses["died"]], variance_rate)
    return pd.concat([pd.DataFrame([numbers]), pulses, curve]).assign(**parameters)


def velocity_numbers(alive: pd.DataFrame, variance_rate: float) -> dict[str, float]:
    """Return the mean and the spread of the velocities of living pulses, and the spread by theory.

    By theory the velocity of a pulse is half of its push, which is the integral of the pre-stress
    from x_*, where the left front stopped, to the pulse. The push makes a random walk: its variance
    grows in proportion to the distance. The result also has the number of cracks among the pulses,
    and the median deviation of a velocity from the exact one (velocity_off).

    alive : rows of the part pulse, for the pulses that have not died
    variance_rate : variance of the push per distance, from `diffusivity`
    """
    errors = (alive["velocity"] - alive["exact_velocity"]).abs()
    return {
        "cracks": int(alive["is_crack"].sum()),
        "velocity_mean": alive["velocity"].mean(),
        "velocity_deviation": alive["velocity"].std(),
        "velocity_predicted": 0.5 * np.sqrt(variance_rate * alive["distance"].mean()),
        "velocity_off": errors.median(),
    }


def predicted_survival(
    distances: np.ndarray, pushes: np.ndarray, parameters: Mapping[str, Any]
) -> np.ndarray:
    """Return the mean over all pulses of the probability to survive to each distance, by theory.

    pushes : push of each pulse (see `push_at`) at START, where its random walk begins
    parameters : parameters of the ensemble of rough pre-stress
    """
    # The theory needs a positive distance, so distances up to START count as one cell beyond it.
    beyond_start = np.maximum(distances - START, CELL_WIDTH)
    # The probabilities have one row per distance and one column per pulse.
    probabilities = first_passage(beyond_start[:, np.newaxis], pushes, parameters)
    return np.mean(probabilities, axis=1)


def prestress_integral(profile: Mapping[str, Any]) -> np.ndarray:
    """Return the integral of the pre-stress over all cells up to each of CELL_MIDDLES."""
    return CELL_WIDTH * np.cumsum(prestress_of(profile)(CELL_MIDDLES))


def push_at(integral: np.ndarray, index: int) -> float:
    """Return the push of a pulse, which is the integral of the pre-stress from x_* to the pulse.

    The left front stops at x_* < 0, where the integral is smallest.

    integral : integral up to each of CELL_MIDDLES, from `prestress_integral`
    index : index of the cell that the pulse has reached
    """
    return float(integral[index] - integral[CELL_MIDDLES < 0.0].min())


def long_distance_rows(ensemble: Ensemble, smooth_profile: dict) -> pd.DataFrame:
    """Return the survival of more pulses over LONG_DISTANCE, without a simulation.

    Each pulse dies where the integral of its pre-stress, from the position at which the left front
    stopped, has fallen to 0.

    ensemble : has the parameters of the rough pre-stress
    smooth_profile : the profile of the run without roughness
    """
    # The random field of the ensemble, on a coarser grid and over a longer distance.
    field_parameters = ensemble.profiles[0]["rough"] | {
        "spacing": LONG_SPACING,
        "stop": LONG_DISTANCE,
    }
    first = field_parameters["start"]
    x = first + LONG_SPACING * np.arange(round((LONG_DISTANCE - first) / LONG_SPACING) + 1)
    # The Gaussian at x = 0 takes the place of the rough background, so there the field is
    # multiplied by 1 minus the Gaussian.
    background_weight = -np.expm1(-0.5 * (x / smooth_profile["width"]) ** 2)
    smooth_prestress = prestress_of(smooth_profile)(x)
    fates = []
    for seed in range(FIRST_LONG_SEED, FIRST_LONG_SEED + LONG_SEEDS):
        field_parameters["seed"] = seed
        prestress = rough(**field_parameters).tau * background_weight + smooth_prestress
        death_position = balance_position(x, LONG_SPACING * np.cumsum(prestress))
        has_died = bool(death_position < LONG_DISTANCE)
        fates.append(Fate(min(death_position, LONG_DISTANCE), has_died))
    row = {"part": "long"} | death_rate(fates, START)
    row |= survival_exponent(fates, ASYMPTOTIC_DISTANCE)
    curve = survival(fates).iloc[::LONG_CURVE_STEP].assign(part="long_survival")
    return pd.concat([pd.DataFrame([row]), curve]).assign(**ensemble.parameters)


def end_state(run: Recorded, integral: np.ndarray) -> dict[str, float]:
    """Return the velocity at the crest of the right pulse at the end, simulated and by theory.

    Also return whether the rupture is still a crack.

    The result contains these numbers:

    velocity : simulated velocity at the crest, where the velocity is largest
    exact_velocity : two waves meet at the crest. One left x_* and ran to the right. The other left
        the right front, and ran to the left. The velocity is half of the integral of the pre-stress
        between the points where they started.
    is_crack : True if the block at START, near the nucleation, still slides

    The argument ``integral`` has the integral of the pre-stress up to each of CELL_MIDDLES.
    """
    crest = crest_position(run, integral)
    start_on_front = start_of_left_running_wave(run, crest)
    integral_to_front = float(np.interp(start_on_front, CELL_MIDDLES, integral))
    # x_* is the position on the left where the integral is smallest.
    integral_to_x_star = integral[CELL_MIDDLES < 0.0].min()
    block = np.searchsorted(run["x"], START)
    still_slides = np.isfinite(run["release_time"][block]) and np.isnan(run["stick_time"][block])
    return {
        "velocity": float(np.interp(crest, run["x"], run["slip_velocity"])),
        "exact_velocity": 0.5 * (integral_to_front - integral_to_x_star),
        "is_crack": bool(still_slides),
    }


def crest_position(run: Recorded, integral: np.ndarray) -> float:
    """Return the position of the crest of the right pulse at the end of a run.

    The crest is the point of largest velocity. It runs to the right at the wave speed, 1. It
    started at x_* < 0 when the left front arrived there and stopped. At x_* the integral of the
    pre-stress is smallest.

    integral : integral of the pre-stress up to each of CELL_MIDDLES
    """
    is_left = CELL_MIDDLES < 0.0
    x_star = float(CELL_MIDDLES[is_left][np.argmin(integral[is_left])])
    end_time = run.attrs["end_time"]
    # A block that was never released counts as released at the end.
    release_time = np.nan_to_num(run["release_time"], nan=end_time)
    departure_time = float(np.interp(x_star, run["x"], release_time))
    return x_star + end_time - departure_time


def start_of_left_running_wave(run: Recorded, position: float) -> float:
    """Return where a wave that runs to the left started on the right front.

    The speed of a wave is 1. If it left the front at the position X and the time t, it is at X + t
    - end_time at the end.

    position : position of the wave at the end
    """
    is_on_front = (run["x"] > 0.0) & np.isfinite(run["release_time"])
    x, time = run["x"][is_on_front], run["release_time"][is_on_front]
    return float(np.interp(position + run.attrs["end_time"], x + time, x))
