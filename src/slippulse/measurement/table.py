"""All measured numbers of one run, as one row of a measured table.

`measure_run` calls the other modules of this package for fronts, transition, pulse and regime. The
functions below it measure the shape of the pulse and the waves of the lattice.
"""

import hashlib
import json
from collections.abc import Mapping
from contextlib import suppress

import numpy as np

from ..data.points import AnyRun
from ..model.prestress import prestress_from
from ..model.recorded_law import read_recorded_law
from ..model.scene import DEFAULTS_OF_EXTRA_TERMS, EXTRA_TERMS, gamma_without_extra_terms
from .front_paths import fit_front, front_position, limit_time
from .pulses import LeadingPulse, acceleration_amplitude, comoving, leading_pulse, slip_variation
from .regime import classify_regime
from .transition import transition_displacement, transition_stress

# Columns that identify a run or describe its computation. `Scene.from_attributes` can make the
# scene of the run from them.
_PARAMETERS = """
    boundary left right width peak steps_and_bumps gamma beta damping_ratio dx max_step duration
    release scheme order half_lattice friction_ratio resolved_blocks run_flags steps block_updates
    energy_residual min_velocity min_stuck_stress friction_ratio_needed re_releases end_time
    friction
"""
PARAMETERS = (*_PARAMETERS.split(), *EXTRA_TERMS)
# Columns that also identify the profile of a run, if the pre-stress is a table.
LABELS = ("profile", "seed")
# The points of a longer table are only in the data file. The measured row has a digest of them.
MAX_POINTS_IN_ROW = 32
PULSE_FIELDS = ("front", "width", "peak_velocity", "slip")
# Waves of the lattice can be measured only if at least this number of blocks slide.
MIN_BLOCKS_WITH_WAVES = 12
# Beyond this number of widths from its centre a Gaussian is taken to be 0.
GAUSSIAN_END_IN_WIDTHS = 6.0


def measure_run(run: AnyRun, settings: Mapping) -> tuple[dict, LeadingPulse | None]:
    """Return all numbers of a run by name, and its leading pulse.

    settings : the settings under ``measure`` in the configuration (see config/README.md)

    A number whose data were not recorded is left out. The pulse is None if slip velocity was not
    recorded.
    """
    attributes = DEFAULTS_OF_EXTRA_TERMS | run.attrs
    attributes["friction"] = json.dumps(read_recorded_law(run.attrs))
    row = {name: attributes[name] for name in PARAMETERS}
    steps = prestress_from(run.attrs).steps
    row["beyond"] = row["right"]
    if steps:
        _, row["beyond"] = steps[-1]
    row |= columns_of_table(run, settings["front_window"])
    for side in ("right", "left"):
        line = fit_front(run, settings["front_window"], side)
        row[f"front_speed_{side}"] = line.slope
        row[f"front_intercept_{side}"] = line.intercept
        row[f"front_speed_error_{side}"] = line.slope_error
    row |= measure_transition(run, settings["fraction"])
    row["first_stick_time"] = run.attrs["first_stick_time"]
    times = settings["trailing_times"]
    trailing_edges = front_position(run, times, "right", "stick_time").tolist()
    for time, trailing_edge in zip(times, trailing_edges, strict=True):
        row[f"trailing_edge_{time:g}"] = trailing_edge
    pulse = None
    if "slip_velocity" in run:
        pulse = leading_pulse(run, settings["front_window"])
        row |= {
            "largest_velocity": float(np.max(np.asarray(run["slip_velocity"]))),
            **{f"pulse_{name}": getattr(pulse, name) for name in PULSE_FIELDS},
            "pulse_stress_drop": gamma_without_extra_terms(run.attrs) * pulse.slip,
            "pulse_acceleration": acceleration_amplitude(run, pulse),
            "slip_variation": slip_variation(run, pulse),
            "pulse_half_width": half_width(run, pulse),
            "lattice_noise": lattice_noise(run),
            "sliding_at_once": sliding_at_once(run),
        }
    if "sample_velocity" in run and run["sample_position"].size > 1:
        row |= classify_regime(run, settings["still"], settings["steady_tolerance"])
        if run.attrs["boundary"] == "stress":
            row |= far_field(run)
    return row, pulse


def columns_of_table(run: AnyRun, window: float) -> dict[str, float | str]:
    """Return the labels of the profile and, if the pre-stress is a table, further columns.

    These are a digest of a long table, the lowest pre-stress that each front has crossed (NaN if it
    has crossed none), and the pre-stress that it crossed last.

    window : the last fraction of a front's path; if the pre-stress is not constant there, the
        pre-stress crossed last is NaN
    """
    profile = prestress_from(run.attrs)
    row: dict[str, float | str] = {name: run.attrs[name] for name in LABELS if name in run.attrs}
    if not profile.points:
        return row
    if len(profile.points) > MAX_POINTS_IN_ROW:
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
        is_in_window = distance >= (1.0 - window) * np.max(distance, initial=0.0)
        crossed_last = tau[is_in_window]
        is_constant = crossed_last.size > 0 and np.ptp(crossed_last) == 0.0
        row[f"level_ahead_{side}"] = float(crossed_last[0]) if is_constant else np.nan
    return row


def measure_transition(run: AnyRun, fraction: float) -> dict:
    """Return the numbers of the transition; none if the paper defines no transition for the run.

    The paper defines it for equal positive levels under a displacement boundary, and for a negative
    level on the left and 0 on the right under a stress boundary. Under a displacement boundary, it
    is measured for a table with different positive levels, too.
    """
    left, right = run.attrs["left"], run.attrs["right"]
    profile = prestress_from(run.attrs)
    if run.attrs["boundary"] == "displacement":
        are_allowed = left == right or bool(profile.points)
        return transition_displacement(run) if left > 0.0 < right and are_allowed else {}
    if left < 0.0 == right and not profile.steps:
        # With a barrier on the right, the integral of the pre-stress may not be positive, so that
        # there is no balance position.
        with suppress(ArithmeticError):
            return transition_stress(run, fraction)
    return {}


def half_width(run: AnyRun, pulse: LeadingPulse) -> float:
    """Return the full width of the pulse at half of its peak slip velocity.

    NaN if slip velocity does not fall below half of the peak on both sides of it, or is not known.
    """
    if np.isnan(pulse.peak_velocity):
        return np.nan
    fields = comoving(run, pulse)
    xi, velocity = fields["xi"], fields["slip_velocity"]
    peak = int(np.argmin(np.abs(xi - (pulse.peak_distance - pulse.front))))
    half = 0.5 * float(velocity[peak])
    is_below = velocity < half
    below_left, below_right = np.flatnonzero(is_below[:peak]), np.flatnonzero(is_below[peak:])
    if not below_left.size or not below_right.size:
        return np.nan
    # Velocity passes the half between a block below it and the next block towards the peak.
    last_left, first_right = int(below_left[-1]), peak + int(below_right[0])
    left_pair, right_pair = [last_left, last_left + 1], [first_right, first_right - 1]
    left = np.interp(half, velocity[left_pair], xi[left_pair])
    right = np.interp(half, velocity[right_pair], xi[right_pair])
    return float(right - left)


def lattice_noise(run: AnyRun) -> float:
    """Return the power of waves that are a few blocks long, divided by the power of slip velocity.

    Only blocks on the right are used. NaN if too few of them slide, or if a velocity is not known.
    """
    x, velocity = np.asarray(run["x"]), np.asarray(run["slip_velocity"])
    # Unknown velocities are NaN. Written with ~, they are included, and the result is NaN.
    moving = velocity[(x >= 0.0) & ~(velocity <= 0.0)]
    if moving.size < MIN_BLOCKS_WITH_WAVES:
        return np.nan
    # The fourth difference, divided by 16, multiplies waves of n blocks by sin^4(pi/n), which is 1
    # for n = 2. The ends are left out, because slip velocity has a corner there.
    short_waves = np.diff(moving, 4)[2:-2] / 16.0
    return float(np.sum(short_waves**2) / np.sum(moving**2))


def sliding_at_once(run: AnyRun) -> float:
    """Return the largest number of blocks on the right that slide at the same time.

    Only the second half of the run is examined. NaN if an exact solution does not know all of it.
    """
    if limit_time(run) <= run.attrs["end_time"]:
        return np.nan
    start = 0.5 * run.attrs["end_time"]
    chosen = (np.asarray(run["x"]) > 0.0) & np.isfinite(np.asarray(run["release_time"]))
    release, stick = np.asarray(run["release_time"])[chosen], np.asarray(run["stick_time"])[chosen]
    # The number is largest right after a release, or at the start of the second half.
    times = np.append(start, release[release > start])
    # The times are nearly in order, for which a stable sort is fast. NaN is sorted last.
    released = np.searchsorted(np.sort(release, kind="stable"), times, side="right")
    stuck = np.searchsorted(np.sort(stick, kind="stable"), times, side="right")
    return float(np.max(released - stuck))


def far_field(run: AnyRun) -> dict[str, float]:
    """Measure how the pulse on the right changes over the last third of a run with samples.

    Only the far field is used, where the pre-stress is constant. ``profile_change`` compares slip
    velocity at the end with the earlier one, moved by the elapsed time at the wave speed, and is
    relative to the earlier peak. ``energy_change`` is the relative change of kinetic and strain
    energy. ``strain_left`` is the strain that remains where the pulse entered the far field,
    divided by the largest strain. All are NaN if nothing slid in the far field at two thirds of the
    duration.
    """
    profile = prestress_from(run.attrs)
    width = profile.width or 1.0
    part_distances = [abs(position) for position, _ in (*profile.steps, *profile.points)]
    start = max([GAUSSIAN_END_IN_WIDTHS * width, *part_distances])
    times, x = np.asarray(run["sample_time"]), np.asarray(run["sample_position"])
    early = int(np.argmin(np.abs(times - 2.0 / 3.0 * times[-1])))
    elapsed = float(times[-1] - times[early])
    velocity, slip = np.asarray(run["sample_velocity"]), np.asarray(run["sample_slip"])
    is_far = x >= start
    if np.count_nonzero(is_far) < 8 or not np.max(velocity[early][is_far], initial=0.0) > 0.0:
        return {"profile_change": np.nan, "energy_change": np.nan, "strain_left": np.nan}
    early_peak = np.max(velocity[early][is_far])
    strain = np.gradient(slip[:, is_far], x[is_far], axis=1)
    final_strain = np.abs(strain[-1])

    def energy(sample: int) -> float:
        """Return the kinetic and strain energy in the far field at a sample."""
        density = 0.5 * (velocity[sample][is_far] ** 2 + strain[sample] ** 2)
        return np.trapezoid(density, x[is_far])

    early_energy, final_energy = energy(early), energy(-1)
    # In units of the wave speed, the elapsed time is also the distance that a wave travels.
    stays_inside = is_far & (x + elapsed <= x[-1])
    final_velocity = np.interp(x[stays_inside] + elapsed, x, velocity[-1])
    largest_change = np.max(np.abs(final_velocity - velocity[early][stays_inside]))
    at_entry = x[is_far] <= start + width
    return {
        "profile_change": float(largest_change / early_peak),
        "energy_change": float(final_energy / early_energy - 1.0),
        "strain_left": float(np.max(final_strain[at_entry]) / np.max(final_strain)),
    }
