"""Every number of one run, with those of the shape of its pulse."""

import json
from collections.abc import Mapping

import numpy as np

from ..data.points import AnyRun
from ..model.prestress import prestress_from
from ..model.recorded_law import law_of
from .fronts import fit_front, position_at
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
# Fewer sliding blocks show no waves of the lattice.
FEWEST = 12
# The Gaussian is 0, to rounding of what is shown, beyond this number of widths.
FAR = 6.0
NAN = float("nan")


def measure_run(run: AnyRun, settings: Mapping) -> tuple[dict, LeadingPulse | None]:
    """Measure one run, out of a sweep or as `simulate` returned it.

    settings : share, front_window, steady_tolerance, still, trailing_times (see config/README.md)

    Returns its parameters and all numbers that the recorded data allow, NaN where one does not
    apply; and its leading pulse, where slip velocity is recorded.
    """
    attributes = run.attrs | {"friction": json.dumps(law_of(run.attrs))}
    row = {name: attributes[name] for name in PARAMETERS}
    steps = prestress_from(run.attrs).steps
    row["beyond"] = steps[-1][1] if steps else row["right"]
    for side in ("right", "left"):
        names = (f"front_speed_{side}", f"front_intercept_{side}", f"front_speed_error_{side}")
        row |= zip(names, fit_front(run, settings["front_window"], side), strict=True)
    row |= transition(run, settings["share"])
    row["first_stick_time"] = run.attrs["first_stick_time"]
    times = settings["trailing_times"]
    edges = position_at(run, times, "right", "stick_time").tolist()
    row |= {f"trailing_edge_{time:g}": edge for time, edge in zip(times, edges, strict=True)}
    pulse = None
    if "slip_velocity" in run:
        pulse = leading_pulse(run, settings["front_window"])
        row |= pulse_numbers(run, pulse)
    if "sample_velocity" in run and run["sample_position"].size > 1:
        row |= classify(run, settings["still"], settings["steady_tolerance"])
        if run.attrs["boundary"] == "stress":
            row |= far_field(run)
    return row, pulse


def transition(run: AnyRun, fraction: float) -> dict:
    """The transition where the paper has one: symmetric levels, or zero beside a negative one."""
    left, right = run.attrs["left"], run.attrs["right"]
    if run.attrs["boundary"] == "displacement":
        return transition_displacement(run) if left == right > 0.0 else {}
    if not left < 0.0 == right or prestress_from(run.attrs).steps:
        return {}
    try:
        return transition_stress(run, fraction)
    except ArithmeticError:
        # A barrier on the right can leave nothing that is balanced on the left.
        return {}


def pulse_numbers(run: AnyRun, pulse: LeadingPulse) -> dict[str, float]:
    """Numbers of the slip velocity at the end, most of them of the leading pulse."""
    return {
        "largest_velocity": float(np.max(np.asarray(run["slip_velocity"]))),
        "pulse_front": pulse.front,
        "pulse_width": pulse.width,
        "pulse_peak_velocity": pulse.peak_velocity,
        "pulse_slip": pulse.slip,
        "pulse_stress_drop": run.attrs["gamma"] * pulse.slip,
        "pulse_acceleration": acceleration_amplitude(run, pulse),
        "slip_variation": slip_variation(run, pulse),
        "pulse_half_width": half_width(run, pulse),
        "lattice_noise": lattice_noise(run),
        "sliding_at_once": sliding_at_once(run),
    }


def half_width(run: AnyRun, pulse: LeadingPulse) -> float:
    """Breadth of slip velocity at half its peak, on the right; NaN without a half on both sides."""
    fields = comoving(run, pulse)
    xi, velocity = fields["xi"], fields["slip_velocity"]
    top = int(np.argmin(np.abs(xi - (pulse.peak_distance - pulse.front))))
    half = 0.5 * float(velocity[top])
    below = velocity < half
    before, after = np.flatnonzero(below[:top]), np.flatnonzero(below[top:])
    if not before.size or not after.size:
        return NAN
    i, j = int(before[-1]), top + int(after[0])
    left = np.interp(half, velocity[[i, i + 1]], xi[[i, i + 1]])
    right = np.interp(half, velocity[[j, j - 1]], xi[[j, j - 1]])
    return float(right - left)


def lattice_noise(run: AnyRun) -> float:
    """Power of waves of a few blocks (fourth difference) over that of slip velocity, on the right.

    The blocks that slide count, without the two at each end, where the velocity has corners.
    """
    x, velocity = np.asarray(run["x"]), np.asarray(run["slip_velocity"])
    moving = velocity[(x >= 0.0) & (velocity > 0.0)]
    if moving.size < FEWEST:
        return NAN
    # The gain is 1 for waves of two blocks, sin^4(pi/n) for waves of n.
    short = np.diff(moving, 4)[2:-2] / 16.0
    return float(np.sum(short**2) / np.sum(moving**2))


def sliding_at_once(run: AnyRun) -> float:
    """Largest number of blocks on the right that slide at once, over the second half of a run."""
    start = 0.5 * run.attrs["end_time"]
    chosen = (np.asarray(run["x"]) > 0.0) & np.isfinite(np.asarray(run["release_time"]))
    release, stick = np.asarray(run["release_time"])[chosen], np.asarray(run["stick_time"])[chosen]
    # The number rises at a release only: it is largest right after one, or at the start.
    times = np.append(start, release[release > start])
    # A stable sort is fast where times are nearly in order. NaN is sorted last.
    released = np.searchsorted(np.sort(release, kind="stable"), times, side="right")
    stuck = np.searchsorted(np.sort(stick, kind="stable"), times, side="right")
    return float(np.max(released - stuck))


def far_field(run: AnyRun) -> dict[str, float]:
    """Change of the right pulse far from nucleation over the last third of a run with samples.

    profile_change : largest difference of the velocity profile from itself moved at the wave speed,
        over its largest velocity
    energy_change : relative change of kinetic plus strain energy
    strain_left : largest strain left where it entered, over the largest strain

    They are NaN where nothing slides there, in uniform pre-stress, at two thirds of the duration.
    """
    steps = [abs(position) for position, _ in prestress_from(run.attrs).steps]
    start = max([FAR * run.attrs["width"], *steps])
    times, x = np.asarray(run["sample_time"]), np.asarray(run["sample_position"])
    early = int(np.argmin(np.abs(times - 2.0 / 3.0 * times[-1])))
    moved = float(times[-1] - times[early])
    velocity, slip = np.asarray(run["sample_velocity"]), np.asarray(run["sample_slip"])
    distant = x >= start
    if np.count_nonzero(distant) < 8 or not np.max(velocity[early][distant], initial=0.0) > 0.0:
        return {"profile_change": NAN, "energy_change": NAN, "strain_left": NAN}
    strain = np.gradient(slip[:, distant], x[distant], axis=1)
    energies = [
        np.trapezoid(0.5 * (velocity[i][distant] ** 2 + strain[i] ** 2), x[distant])
        for i in (early, -1)
    ]
    inside = distant & (x + moved <= x[-1])
    later = np.interp(x[inside] + moved, x, velocity[-1])
    entered = x[distant] <= start + run.attrs["width"]
    changed = np.max(np.abs(later - velocity[early][inside]))
    return {
        "profile_change": float(changed / np.max(velocity[early][distant])),
        "energy_change": float(energies[1] / energies[0] - 1.0),
        "strain_left": float(np.max(np.abs(strain[-1][entered])) / np.max(np.abs(strain[-1]))),
    }
