"""Every number of one run, with those of the shape of its pulse."""

import hashlib
import json
from collections.abc import Mapping
from contextlib import suppress

import numpy as np

from ..data.points import AnyRun
from ..model.prestress import prestress_from
from ..model.recorded_law import law_of
from .front_paths import fit_front, limit_time, position_at
from .pulses import LeadingPulse, acceleration_amplitude, comoving, leading_pulse, slip_variation
from .regime import classify
from .transition import transition_displacement, transition_stress

# Columns that name a run rather than measure it; `Scene.from_attributes` has its scene from them.
PARAMETERS = (
    "boundary", "left", "right", "width", "peak", "steps_and_bumps", "gamma", "beta",
    "damping_ratio", "dx", "max_step", "duration", "release", "scheme", "order", "half_lattice",
    "friction_ratio", "resolved_blocks", "run_flags", "steps", "block_updates", "energy_residual",
    "min_velocity", "min_stuck_stress", "friction_ratio_needed", "re_releases", "end_time",
    "friction",
)  # fmt: skip
# Columns that name the profile of a run too, where a simulation has a table of pre-stress.
LABELS = ("profile", "seed")
# A longer table is in the data file alone, and in the measured row by its digest.
MOST_POINTS_IN_A_ROW = 32
WHOLE_PULSE = ("front", "width", "peak_velocity", "slip")
# Fewer sliding blocks show no waves of the lattice.
FEWEST = 12
# The Gaussian is 0, to rounding of what is shown, beyond this number of widths.
FAR = 6.0


def measure_run(run: AnyRun, settings: Mapping) -> tuple[dict, LeadingPulse | None]:
    """Parameters and all recorded numbers of a run, and its leading pulse where it has velocities.

    settings : those of `measure` (see config/README.md)
    """
    attributes = run.attrs | {"friction": json.dumps(law_of(run.attrs))}
    row = {name: attributes[name] for name in PARAMETERS}
    steps = prestress_from(run.attrs).steps
    row["beyond"] = steps[-1][1] if steps else row["right"]
    row |= columns_of_table(run, settings["front_window"])
    for side in ("right", "left"):
        names = (f"front_speed_{side}", f"front_intercept_{side}", f"front_speed_error_{side}")
        row |= zip(names, fit_front(run, settings["front_window"], side), strict=True)
    row |= transition(run, settings["share"])
    row["first_stick_time"] = run.attrs["first_stick_time"]
    times = settings["trailing_times"]
    edges = position_at(run, times, "right", "stick_time").tolist()
    row |= zip([f"trailing_edge_{time:g}" for time in times], edges, strict=True)
    pulse = None
    if "slip_velocity" in run:
        pulse = leading_pulse(run, settings["front_window"])
        row |= {
            "largest_velocity": float(np.max(np.asarray(run["slip_velocity"]))),
            **{f"pulse_{name}": getattr(pulse, name) for name in WHOLE_PULSE},
            "pulse_stress_drop": run.attrs["gamma"] * pulse.slip,
            "pulse_acceleration": acceleration_amplitude(run, pulse),
            "slip_variation": slip_variation(run, pulse),
            "pulse_half_width": half_width(run, pulse),
            "lattice_noise": lattice_noise(run),
            "sliding_at_once": sliding_at_once(run),
        }
    if "sample_velocity" in run and run["sample_position"].size > 1:
        row |= classify(run, settings["still"], settings["steady_tolerance"])
        if run.attrs["boundary"] == "stress":
            row |= far_field(run)
    return row, pulse


def columns_of_table(run: AnyRun, window: float) -> dict[str, float | str]:
    """Return the labels of the profile, and the numbers of a table if the pre-stress is one.

    These are the digest of a long table, the lowest pre-stress that each front has crossed, and its
    level if it is constant on the last ``window`` of the front's path; NaN if it is not.
    """
    profile = prestress_from(run.attrs)
    row: dict[str, float | str] = {name: run.attrs[name] for name in LABELS if name in run.attrs}
    if not profile.points:
        return row
    if len(profile.points) > MOST_POINTS_IN_A_ROW:
        text = run.attrs["steps_and_bumps"]
        parts = json.loads(text)
        digest = hashlib.sha256(text.encode()).hexdigest()[:16]
        parts["points"] = f"{len(profile.points)} points, {digest}"
        row["steps_and_bumps"] = json.dumps(parts)
    x, released = np.asarray(run["x"]), np.isfinite(np.asarray(run["release_time"]))
    for side, sign in (("left", -1.0), ("right", 1.0)):
        crossed = released & (sign * x >= 0.0)
        tau = np.asarray(run["prestress"])[crossed]
        row[f"lowest_prestress_{side}"] = float(np.min(tau)) if tau.size else np.nan
        distance = np.abs(x[crossed])
        last = tau[distance >= (1.0 - window) * np.max(distance, initial=0.0)]
        constant = last.size > 0 and np.ptp(last) == 0.0
        row[f"level_ahead_{side}"] = float(last[0]) if constant else np.nan
    return row


def transition(run: AnyRun, fraction: float) -> dict:
    """The transition where the paper has one: symmetric levels, or zero beside a negative one."""
    left, right = run.attrs["left"], run.attrs["right"]
    if run.attrs["boundary"] == "displacement":
        table = bool(prestress_from(run.attrs).points)
        return (
            transition_displacement(run) if left > 0.0 < right and (left == right or table) else {}
        )
    if left < 0.0 == right and not prestress_from(run.attrs).steps:
        # A barrier on the right can leave nothing that is balanced on the left.
        with suppress(ArithmeticError):
            return transition_stress(run, fraction)
    return {}


def half_width(run: AnyRun, pulse: LeadingPulse) -> float:
    """Breadth of slip velocity at half its peak, on the right; NaN without a half on both sides."""
    if np.isnan(pulse.peak_velocity):
        return np.nan
    fields = comoving(run, pulse)
    xi, velocity = fields["xi"], fields["slip_velocity"]
    top = int(np.argmin(np.abs(xi - (pulse.peak_distance - pulse.front))))
    half = 0.5 * float(velocity[top])
    below = velocity < half
    before, after = np.flatnonzero(below[:top]), np.flatnonzero(below[top:])
    if not before.size or not after.size:
        return np.nan
    i, j = int(before[-1]), top + int(after[0])
    left = np.interp(half, velocity[[i, i + 1]], xi[[i, i + 1]])
    right = np.interp(half, velocity[[j, j - 1]], xi[[j, j - 1]])
    return float(right - left)


def lattice_noise(run: AnyRun) -> float:
    """Power of waves of a few blocks (fourth difference) over that of velocity, on the right."""
    x, velocity = np.asarray(run["x"]), np.asarray(run["slip_velocity"])
    moving = velocity[(x >= 0.0) & ~(velocity <= 0.0)]
    # A velocity that is not known is NaN, and so is the noise.
    if moving.size < FEWEST:
        return np.nan
    # The gain is 1 for waves of two blocks, sin^4(pi/n) for waves of n. At the ends are corners.
    short = np.diff(moving, 4)[2:-2] / 16.0
    return float(np.sum(short**2) / np.sum(moving**2))


def sliding_at_once(run: AnyRun) -> float:
    """Largest number of blocks on the right that slide at once, over the second half of a run."""
    if limit_time(run) <= run.attrs["end_time"]:
        return np.nan
    start = 0.5 * run.attrs["end_time"]
    chosen = (np.asarray(run["x"]) > 0.0) & np.isfinite(np.asarray(run["release_time"]))
    release, stick = np.asarray(run["release_time"])[chosen], np.asarray(run["stick_time"])[chosen]
    # The number is largest right after a release, or at the start.
    times = np.append(start, release[release > start])
    # A stable sort is fast where times are nearly in order. NaN is sorted last.
    released = np.searchsorted(np.sort(release, kind="stable"), times, side="right")
    stuck = np.searchsorted(np.sort(stick, kind="stable"), times, side="right")
    return float(np.max(released - stuck))


def far_field(run: AnyRun) -> dict[str, float]:
    """Change of the right pulse far from nucleation over the last third of a run with samples.

    Its profile is compared with itself moved at the wave speed, its energy is kinetic and strain,
    and strain is left where it entered. NaN where nothing slides at two thirds of the duration.
    """
    profile = prestress_from(run.attrs)
    width = profile.width or 1.0
    parts = [abs(position) for position, _ in (*profile.steps, *profile.points)]
    start = max([FAR * width, *parts])
    times, x = np.asarray(run["sample_time"]), np.asarray(run["sample_position"])
    early = int(np.argmin(np.abs(times - 2.0 / 3.0 * times[-1])))
    moved = float(times[-1] - times[early])
    velocity, slip = np.asarray(run["sample_velocity"]), np.asarray(run["sample_slip"])
    distant = x >= start
    if np.count_nonzero(distant) < 8 or not np.max(velocity[early][distant], initial=0.0) > 0.0:
        return {"profile_change": np.nan, "energy_change": np.nan, "strain_left": np.nan}
    strain = np.gradient(slip[:, distant], x[distant], axis=1)
    densities = [0.5 * (velocity[i][distant] ** 2 + strain[i] ** 2) for i in (early, -1)]
    energies = [np.trapezoid(density, x[distant]) for density in densities]
    inside = distant & (x + moved <= x[-1])
    later = np.interp(x[inside] + moved, x, velocity[-1])
    entered = x[distant] <= start + width
    changed = np.max(np.abs(later - velocity[early][inside]))
    return {
        "profile_change": float(changed / np.max(velocity[early][distant])),
        "energy_change": float(energies[1] / energies[0] - 1.0),
        "strain_left": float(np.max(np.abs(strain[-1][entered])) / np.max(np.abs(strain[-1]))),
    }
