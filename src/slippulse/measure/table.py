"""Every number of one run."""

from collections.abc import Mapping

import numpy as np
import xarray as xr

from ..model.prestress import prestress_from
from .fronts import front_speed, position_at
from .pulses import LeadingPulse, acceleration_amplitude, leading_pulse, slip_variation
from .regime import classify
from .shape import far_field, half_width, lattice_noise, sliding_at_once
from .transition import transition_displacement, transition_stress

# What names a run rather than measures it; enough to have its scene back (`Scene.from_attributes`).
PARAMETERS = (
    "boundary", "left", "right", "width", "peak", "steps_and_bumps", "gamma", "beta", "damping_ratio", "dx", "max_step",
    "duration", "release", "scheme", "order", "half_lattice", "friction_ratio", "resolved_blocks", "run_flags", "steps",
    "block_updates", "energy_residual", "min_velocity", "min_stuck_stress", "friction_ratio_needed", "re_releases",
    "end_time", "rate_strengthening",
)  # fmt: skip


def measure_run(run: xr.Dataset, settings: Mapping) -> tuple[dict, LeadingPulse | None]:
    """Measure one run, out of a sweep or as `simulate` returned it.

    settings : share, front_window, steady_tolerance, still, trailing_times (see config/README.md)

    Returns its parameters, then what the recorded data allow, NaN where a quantity does not apply; and its leading
    pulse, where slip velocity is recorded.
    """
    # A file from before the last of them opens as the paper's model.
    row = {name: run.attrs[name] for name in PARAMETERS[:-1]}
    row[PARAMETERS[-1]] = run.attrs.get(PARAMETERS[-1], 0.0)
    steps = prestress_from(run.attrs).steps
    row["beyond"] = steps[-1][1] if steps else row["right"]
    for side in ("right", "left"):
        names = (f"front_speed_{side}", f"front_intercept_{side}", f"front_speed_error_{side}")
        row |= zip(names, front_speed(run, settings["front_window"], side), strict=True)
    if run.attrs["boundary"] == "displacement" and run.attrs["left"] == run.attrs["right"] > 0.0:
        row |= transition_displacement(run)
    if run.attrs["boundary"] == "stress" and run.attrs["left"] < 0.0 == run.attrs["right"] and not steps:
        row |= transition_stress(run, settings["share"])
    row["first_stick_time"] = run.attrs["first_stick_time"]
    times = settings["trailing_times"]
    edges = position_at(run, times, "right", "stick_time").tolist()
    row |= {f"trailing_edge_{time:g}": edge for time, edge in zip(times, edges, strict=True)}
    pulse = None
    if "slip_velocity" in run:
        pulse = leading_pulse(run, settings["front_window"])
        row |= {
            "largest_velocity": float(np.max(run["slip_velocity"].values)),
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
    if "sample_velocity" in run and run.sizes["sample_position"] > 1:
        row |= classify(run, settings["still"], settings["steady_tolerance"])
        if run.attrs["boundary"] == "stress":
            row |= far_field(run)
    return row, pulse
