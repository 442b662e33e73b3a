"""All measured numbers of one run, as one row of a measured table.

`measure_run` calls the other modules of this package for fronts, transition, pulse and regime. The
functions below it measure the pre-stress that the fronts have crossed, the shape of the pulse, and
the waves of the lattice.
"""

import hashlib
import json
from collections.abc import Container, Mapping
from contextlib import suppress

import numpy as np

from ..data.points import AnyRun
from ..model.prestress import Prestress, prestress_from
from ..model.recorded_law import read_recorded_law
from ..model.scene import DEFAULTS_OF_EXTRA_TERMS, EXTRA_TERMS, gamma_without_extra_terms
from .front_paths import fit_front, front_position, limit_time
from .nucleation import position_of_nucleation
from .pulses import LeadingPulse, acceleration_amplitude, comoving, leading_pulse, slip_variation
from .regime import classify_regime
from .transition import transition_displacement, transition_stress

# Columns that identify a run or describe its computation. From them, `Scene.from_attributes` can
# rebuild the scene of the run.
_PARAMETERS = """
    boundary left right width peak steps_and_bumps gamma beta damping_ratio dx max_step duration
    release scheme order half_lattice friction_ratio resolved_blocks run_flags steps block_updates
    energy_residual min_velocity min_stuck_stress friction_ratio_needed re_releases end_time
    friction
"""
PARAMETERS = (*_PARAMETERS.split(), *EXTRA_TERMS)
# Columns that also identify the profile of a run, if the pre-stress is a table.
LABELS = ("profile", "seed")
# A row holds the points of a pre-stress table with at most this number of points. Of a longer table
# it holds a digest; the points are in the data file.
MAX_POINTS_IN_ROW = 32
PULSE_FIELDS = ("front", "width", "peak_velocity", "slip")
# Waves of the lattice can be measured only if at least this number of blocks slide.
MIN_BLOCKS_WITH_WAVES = 12
# Beyond this number of widths from its centre a Gaussian is taken to be 0.
GAUSSIAN_END_IN_WIDTHS = 6.0
# The far field is measured only if it has at least this number of sampled positions.
MIN_FAR_SAMPLES = 8


def run_columns(columns: Container[str]) -> list[str]:
    """Return those columns of a measured table that identify a run or describe its computation."""
    return [*PARAMETERS, *(label for label in LABELS if label in columns)]


def measure_run(run: AnyRun, settings: Mapping) -> tuple[dict, LeadingPulse | None]:
    """Return all numbers of a run by name, and its leading pulse.

    settings : the settings under ``measure`` in the configuration

        - front_window: fraction of a front's path, at its end, over which its speed is measured
        - fraction: under a stress boundary, the transition is measured when the left front has
          covered this fraction of its way to the balance position
        - trailing_times: times at which the position of the trailing edge is measured
        - still: a block counts as at rest below this fraction of the largest slip velocity
        - steady_tolerance: largest relative change of a steady pulse

    A number is left out if the data that it needs were not recorded. The pulse is None if slip
    velocity was not recorded.
    """
    # The parameters of the run. Older files lack extra terms, or have the friction in another form.
    attributes = DEFAULTS_OF_EXTRA_TERMS | run.attrs
    attributes["friction"] = json.dumps(read_recorded_law(run.attrs))
    row = {name: attributes[name] for name in PARAMETERS}
    # Further numbers that describe the pre-stress.
    row |= profile_columns(run, settings["front_window"])
    # Fronts, transition and trailing edge.
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
    # The pulse, which needs the fields at the end of the run.
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
    # The regime, which needs samples.
    has_samples = "sample_velocity" in run and np.size(run["sample_velocity"]) > 0
    if has_samples and run["sample_position"].size > 1:
        row |= classify_regime(run, settings["still"], settings["steady_tolerance"])
        if run.attrs["boundary"] == "stress":
            # Changes of the pulse where the pre-stress is constant, far from the nucleation.
            row |= far_field(run)
    return row, pulse


def profile_columns(run: AnyRun, window: float) -> dict[str, float | str]:
    """Return the columns of a run that describe its pre-stress, in addition to PARAMETERS.

    The columns are:

    beyond : level into which the right front runs: that of the outermost step on the right, or the
        right level if there is none
    profile, seed : labels of the profile, if the run has them
    steps_and_bumps : the steps, bumps and points as JSON, without the points of a long table; this
        column and the next ones only if the pre-stress is a table of points
    lowest_prestress_SIDE, level_ahead_SIDE : lowest pre-stress that the front has crossed, and the
        constant one that it crossed last

    window : the last part of a front's path, as a fraction of the path
    """
    profile = prestress_from(run.attrs)
    steps_on_right = [step for step in profile.steps if step[0] > 0.0]
    # Each step is a pair of its position and its level.
    _, outermost_level = max(steps_on_right, default=(0.0, run.attrs["right"]))
    row = {"beyond": outermost_level}
    row |= {name: run.attrs[name] for name in LABELS if name in run.attrs}
    if profile.points:
        row["steps_and_bumps"] = shortened_table(run.attrs["steps_and_bumps"])
        row |= crossed_prestress(run, window)
    return row


def shortened_table(profile_as_json: str) -> str:
    """Return a recorded profile (JSON text), with a digest in place of the points of a long table.

    A table is long if it has more than MAX_POINTS_IN_ROW points. Different tables have different
    digests, so that their profiles can still be told apart.
    """
    parts = json.loads(profile_as_json)
    point_count = len(parts["points"])
    if point_count <= MAX_POINTS_IN_ROW:
        return profile_as_json
    digest = hashlib.sha256(profile_as_json.encode()).hexdigest()[:16]
    return json.dumps(parts | {"points": f"{point_count} points, {digest}"})


def crossed_prestress(run: AnyRun, window: float) -> dict[str, float]:
    """Return the lowest pre-stress that each front has crossed, and the level that it crossed last.

    These numbers have the names lowest_prestress_SIDE, which is NaN if the front has crossed no
    block, and level_ahead_SIDE, which is NaN if the pre-stress is not constant over the window.

    window : the last part of a front's path, as a fraction of the path
    """
    numbers = {}
    x, was_released = np.asarray(run["x"]), np.isfinite(np.asarray(run["release_time"]))
    for side, is_on_side in (("left", x <= 0.0), ("right", x >= 0.0)):
        was_crossed = was_released & is_on_side
        tau, distance = np.asarray(run["prestress"])[was_crossed], np.abs(x[was_crossed])
        numbers[f"lowest_prestress_{side}"] = float(np.min(tau)) if tau.size else np.nan
        is_in_window = distance >= (1.0 - window) * np.max(distance, initial=0.0)
        crossed_last = tau[is_in_window]
        is_constant = crossed_last.size > 0 and np.ptp(crossed_last) == 0.0
        numbers[f"level_ahead_{side}"] = float(crossed_last[0]) if is_constant else np.nan
    return numbers


def measure_transition(run: AnyRun, fraction: float) -> dict:
    """Return the numbers of the transition by name; none if the run has no defined transition.

    Under a displacement boundary, the paper defines a transition for equal positive levels. If the
    pre-stress is a table of points, the transition is measured for different positive levels, too.
    Under a stress boundary, the paper defines a transition for a negative level on the left and the
    level 0 on the right, without steps.

    fraction : under a stress boundary, the transition is the time at which the left front has
        covered this fraction of its way to the balance position
    """
    left, right = run.attrs["left"], run.attrs["right"]
    profile = prestress_from(run.attrs)
    if run.attrs["boundary"] == "displacement":
        are_positive = left > 0.0 and right > 0.0
        are_allowed = left == right or bool(profile.points)
        return transition_displacement(run) if are_positive and are_allowed else {}
    if left < 0.0 and right == 0.0 and not profile.steps:
        # A barrier on the right can make the integral of the pre-stress negative. Then there is no
        # balance position.
        with suppress(ArithmeticError):
            return transition_stress(run, fraction)
    return {}


def half_width(run: AnyRun, pulse: LeadingPulse) -> float:
    """Return the width of the pulse between the two positions with half of its peak velocity.

    NaN if slip velocity does not fall below half of the peak on both sides of it, or if it is not
    known.
    """
    if np.isnan(pulse.peak_velocity):
        return np.nan
    # Positions relative to the front, and slip velocities, of the blocks on the right.
    fields = comoving(run, pulse)
    xi, velocity = fields["xi"], fields["slip_velocity"]
    # The block that is nearest to the peak.
    peak = int(np.argmin(np.abs(xi - (pulse.peak_distance - pulse.front))))
    half_velocity = 0.5 * float(velocity[peak])
    is_below = velocity < half_velocity
    below_left, below_right = np.flatnonzero(is_below[:peak]), np.flatnonzero(is_below[peak:])
    if not below_left.size or not below_right.size:
        return np.nan
    # On each side, the velocity is half of the peak somewhere between the nearest block below this
    # value and its neighbour towards the peak.
    last_left, first_right = int(below_left[-1]), peak + int(below_right[0])
    left_pair, right_pair = [last_left, last_left + 1], [first_right, first_right - 1]
    left = np.interp(half_velocity, velocity[left_pair], xi[left_pair])
    right = np.interp(half_velocity, velocity[right_pair], xi[right_pair])
    return float(right - left)


def lattice_noise(run: AnyRun) -> float:
    """Return the power of waves that are a few blocks long, divided by the power of slip velocity.

    Only blocks on the right are used. NaN if too few of them slide, or if a velocity is not known.
    """
    x, velocity = np.asarray(run["x"]), np.asarray(run["slip_velocity"])
    # An unknown velocity is NaN. The condition ~(NaN <= 0) is true, so that the result is NaN.
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
    release, stick = np.asarray(run["release_time"]), np.asarray(run["stick_time"])
    has_slipped = (np.asarray(run["x"]) > 0.0) & np.isfinite(release)
    release, stick = release[has_slipped], stick[has_slipped]
    # The number is largest right after a release, or at the start of the second half.
    times = np.append(start, release[release > start])
    # Count the releases and the sticks up to each time. The times are nearly in order, for which a
    # stable sort is fast. NaN is sorted last, so that it is not counted.
    released_count = np.searchsorted(np.sort(release, kind="stable"), times, side="right")
    stuck_count = np.searchsorted(np.sort(stick, kind="stable"), times, side="right")
    return float(np.max(released_count - stuck_count))


def _start_of_far_field(profile: Prestress, width: float, nucleation: float) -> float:
    """Return the position to the right of which there are no Gaussians, steps and points.

    width : standard deviation of the Gaussian at x = 0 or, if there is none, a distance beyond
        which the nucleation is far away
    nucleation : position of the nucleation
    """
    ends = [centre + GAUSSIAN_END_IN_WIDTHS * bump_width for centre, _, bump_width in profile.bumps]
    ends += [position for position, _ in (*profile.steps, *profile.points)]
    centre = nucleation if profile.width is None else 0.0
    return max([centre + GAUSSIAN_END_IN_WIDTHS * width, *ends])


def far_field(run: AnyRun) -> dict[str, float]:
    """Measure how the pulse on the right changes from an early time to the end of a run.

    The early time is the sampled time at two thirds of the run. Only the far field is used, which
    lies to the right of all Gaussians, steps and points, so that the pre-stress is constant.

    The result contains these numbers:

    profile_change : largest change of slip velocity in the frame that moves at the wave speed,
        divided by the early peak velocity
    energy_change : relative change of the sum of kinetic and strain energy
    strain_left : strain that is left where the pulse entered the far field, in its first Gaussian
        width: the largest strain there at the end of the run, divided by the largest strain
        anywhere in the far field at that time

    All are NaN if nothing slid in the far field at the early time, or if too few positions are
    sampled there. profile_change is NaN if the sampled far field is shorter than the distance that
    waves run between the two times. strain_left is NaN if no position near the entry is sampled, or
    if the final strain is 0.
    """
    profile = prestress_from(run.attrs)
    # If there is no Gaussian, its width is None. The unit of length takes its place.
    width = profile.width or 1.0
    nucleation = position_of_nucleation(run)
    far_start = _start_of_far_field(profile, width, nucleation) - nucleation
    times = np.asarray(run["sample_time"])
    # Sampled positions may be in any order, and may repeat.
    x, order = np.unique(np.asarray(run["sample_position"]), return_index=True)
    # Index of the early time. The index of the final time is -1.
    early = int(np.argmin(np.abs(times - 2.0 / 3.0 * times[-1])))
    early_velocity, final_velocity = np.asarray(run["sample_velocity"])[[early, -1]][:, order]
    early_slip, final_slip = np.asarray(run["sample_slip"])[[early, -1]][:, order]
    is_far = x >= far_start
    early_peak = np.max(early_velocity[is_far], initial=0.0)
    if np.count_nonzero(is_far) < MIN_FAR_SAMPLES or not early_peak > 0.0:
        return {"profile_change": np.nan, "energy_change": np.nan, "strain_left": np.nan}
    far_x = x[is_far]
    early_strain = np.gradient(early_slip[is_far], far_x)
    final_strain = np.gradient(final_slip[is_far], far_x)
    # The sum of kinetic and strain energy.
    early_energy = np.trapezoid(0.5 * (early_velocity[is_far] ** 2 + early_strain**2), far_x)
    final_energy = np.trapezoid(0.5 * (final_velocity[is_far] ** 2 + final_strain**2), far_x)
    # A wave travels this distance from the early time to the end, because the wave speed is 1. Each
    # early velocity is compared with the final velocity at this distance ahead, if it is sampled.
    travelled = float(times[-1] - times[early])
    is_compared = is_far & (x + travelled <= x[-1])
    velocity_ahead = np.interp(x[is_compared] + travelled, x, final_velocity)
    changes = np.abs(velocity_ahead - early_velocity[is_compared])
    largest_change = np.max(changes) if changes.size else np.nan
    entry_strain = np.abs(final_strain[far_x <= far_start + width])
    largest_strain = np.max(np.abs(final_strain))
    strain_left = np.nan
    if entry_strain.size and largest_strain > 0.0:
        strain_left = float(np.max(entry_strain) / largest_strain)
    return {
        "profile_change": float(largest_change / early_peak),
        "energy_change": float(final_energy / early_energy - 1.0),
        "strain_left": strain_left,
    }
