"""Conversion of a run's numbers to and from SI units, by the quantity that each number measures."""

import json
from collections.abc import Callable, Mapping
from typing import Any

# SI unit of each quantity, as UDUNITS and the CF conventions write it. In SI units a stress is
# counted from 0; in the model it is counted from kinetic friction. A difference of two stresses is
# the same in both. Energies are per metre of interface width.
UNITS = {
    "length": "m",
    "time": "s",
    "speed": "m s-1",
    "slip": "m",
    "slip_velocity": "m s-1",
    "slip_acceleration": "m s-2",
    "stress": "Pa",
    "stress_difference": "Pa",
    "damping": "m2 s-1",
    "energy": "J m-1",
}
# Quantity and description of each variable of a run.
VARIABLES = {
    "x": ("length", "position"),
    "prestress": ("stress", "initial shear stress"),
    "release_time": (
        "time",
        "time at which the block is first released; NaN if it is never released",
    ),
    "stick_time": (
        "time",
        "time at which the block last sticks; NaN if it slides at the end or never sticks",
    ),
    "slip": ("slip", "slip at the end of the run"),
    "slip_velocity": ("slip_velocity", "slip velocity at the end of the run"),
    "slip_acceleration": ("slip_acceleration", "slip acceleration at the end of the run"),
    "sample_time": ("time", "time of a sample"),
    "sample_position": ("length", "position of a sample"),
    "sample_slip": ("slip", "slip at the sampled times and positions"),
    "sample_velocity": ("slip_velocity", "slip velocity at the sampled times and positions"),
}
# Names of attributes and measured numbers, by quantity. A number that is not listed has no unit.
_NAMES_BY_QUANTITY = {
    "length": """
        x position width dx first_stick_position limit_position front_intercept_right
        front_intercept_left transition_length balance_distance last_release_distance
        last_release_length paper_transition_length exact_transition_length pulse_front pulse_width
        pulse_half_width slip_length_background slip_length_nucleation exact_pulse_width
        exact_balance_distance exact_half_width paper_pulse_width
    """,
    "time": """
        duration end_time first_stick_time limit_time transition_time last_release_time
        paper_transition_time exact_transition_time slip_time_background slip_time_nucleation
        exact_first_stick_time
    """,
    "speed": """
        front_speed_right front_speed_left front_speed_error_right front_speed_error_left
        late_front_speed_left late_front_speed_right exact_front_speed_left exact_front_speed_right
        paper_front_speed_left paper_front_speed_right lattice_front_speed_left
        lattice_front_speed_right
    """,
    "slip": "pulse_slip paper_pulse_slip exact_pulse_slip exact_left_pulse_slip",
    "slip_velocity": """
        min_velocity largest_velocity pulse_peak_velocity exact_largest_velocity
        paper_pulse_peak_velocity exact_pulse_peak_velocity exact_left_pulse_peak_velocity
    """,
    "slip_acceleration": "pulse_acceleration paper_pulse_acceleration exact_pulse_acceleration",
    "stress": """
        left right peak beyond min_stuck_stress level_ahead_left level_ahead_right
        lowest_prestress_left lowest_prestress_right
    """,
    "stress_difference": "pulse_stress_drop",
    "damping": "beta",
    "energy": """
        work_of_prestress kinetic_energy elastic_energy leaf_spring_energy viscous_loss event_loss
        friction_loss
    """,
}
QUANTITIES = {name: quantity for name, (quantity, _) in VARIABLES.items()}
for _quantity, _names in _NAMES_BY_QUANTITY.items():
    QUANTITIES |= dict.fromkeys(_names.split(), _quantity)
# Quantities of the numbers in a row, for each part of a pre-stress. A data file has the parts as
# JSON.
PROFILE_QUANTITIES = {
    "steps": ("length", "stress"),
    "bumps": ("length", "stress_difference", "length"),
    "points": ("length", "stress"),
}
# A function that converts its first argument, a number or an array. The second argument is the name
# of its quantity.
Converter = Callable[[Any, str], Any]


def converted_run(run: Any, convert: Converter) -> Any:
    """Return the Dataset of a run with all variables and attributes converted.

    convert : converts a number or an array, given the name of its quantity
    """
    variables = {}
    for name, variable in run.variables.items():
        # The second value is a description.
        quantity, _ = VARIABLES[name]
        variables[name] = (variable.dims, convert(variable.values, quantity), variable.attrs)
    coordinates = {name: variables.pop(name) for name in run.coords}
    converted = run.assign_coords(coordinates).assign(variables)
    converted.attrs = converted_numbers(run.attrs, convert)
    return converted


def converted_numbers(numbers: Mapping[str, Any], convert: Converter) -> dict[str, Any]:
    """Return all numbers by name; those that have a unit are converted.

    The parts of the pre-stress, which are recorded as a JSON text, are converted, too.

    convert : converts a number, given the name of its quantity
    """
    # QUANTITIES has the name of the quantity, such as "length", of each number that has a unit.
    converted = dict(numbers)
    for name in QUANTITIES.keys() & converted.keys():
        if converted[name] is not None:
            converted[name] = convert(converted[name], QUANTITIES[name])
    if "steps_and_bumps" in converted:
        converted["steps_and_bumps"] = _converted_parts(converted["steps_and_bumps"], convert)
    return converted


def _converted_parts(text: str, convert: Converter) -> str:
    """Convert the steps, bumps and points of a pre-stress, which are given and returned as JSON.

    convert : converts a number, given the name of its quantity
    """
    parts = json.loads(text)
    for part, rows in parts.items():
        # In a row of measured numbers, a digest (text) may take the place of many points.
        if isinstance(rows, list):
            # The quantity of each number in a row, such as (length, stress) for a step.
            quantities = PROFILE_QUANTITIES[part]
            parts[part] = [list(map(convert, row, quantities)) for row in rows]
    return json.dumps(parts)
