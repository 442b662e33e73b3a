"""Results in SI units: the pulse of a layer, and the stress drop of a fault with a damage zone."""

import math

import pandas as pd

from ..model.checks import as_numbers, check_kind, check_number, check_that
from ..model.layer_units import Layer
from ..model.si_quantities import QUANTITIES, UNITS
from .closed_pulse import paper_pulse, paper_transition_displacement
from .exact_transition import uniform_transition_time
from .front_speeds import front_speed, front_speed_undamped
from .pulse import steady_pulse

PEAK_VELOCITY_NOTE = (
    "The paper prints the strength drop divided by sqrt(2 G rho). With the paper's own unit of "
    "slip under held displacement, 2 H (mu_s - mu_k) sigma_n/(lambda + 2G), the value is twice as "
    "large. The printed value results from the unit of slip that applies if the stress is held. "
    "The printed value is the peak velocity of the slip averaged over the height."
)
STRESS_DROP_NOTE = (
    "The paper calls the strength drop (mu_s - mu_k) sigma_n the stress drop. By the paper's "
    "equation (C13), stress falls by twice the amount by which the initial stress exceeds kinetic "
    "friction."
)
TRANSITION_NOTE = (
    "The paper neglects the elastic coupling. The exact value is for a rupture that starts at a"
    " point."
)


def layer_results(
    layer: Layer, initial_stress: float, damping_ratio: float = 0.0, release: str = "total"
) -> pd.DataFrame:
    """Return transition and steady pulse of a layer with held top, by the paper and exactly.

    The initial stress is uniform. Source of the paper's values: section IV A, as printed, for
    transition length, pulse width and peak slip velocity; section III for the others.

    Parameters
    ----------
    layer : Layer
        With top "held": the paper has no such formulas under held stress.
    initial_stress : float, Pa
        Shear stress along the interface, between kinetic and static friction.
    damping_ratio, release : as in `front_speed`
        They determine the exact front speed; the pulse behind it is that of the continuum limit.

    Returns
    -------
    pandas.DataFrame
        One row for each quantity with columns unit, paper, exact, and note, which explains a
        difference between the two values.

    Raises
    ------
    ValueError
        In one line that names the argument, its value and what is allowed.

    Examples
    --------
    >>> block = sp.Layer(0.02, 2e9, poisson_ratio=0.3, density=1200.0, static_friction=0.6,
    ...                  kinetic_friction=0.5, normal_stress=5e6)
    >>> results = layer_results(block, 2.7e6)
    >>> ratio = results.exact / results.paper
    >>> round(float(ratio["pulse_peak_velocity"]), 12)
    2.0
    """
    check_kind("layer", layer, Layer)
    check_that(layer.top == "held", "layer.top", layer.top, "'held'")
    lowest, highest = layer.kinetic_strength, layer.static_strength
    check_number("initial_stress", initial_stress, above=lowest, below=highest)
    tau0, gamma = float(layer.convert_from_si(initial_stress, "stress")), layer.gamma
    speed = float(front_speed(tau0, damping_ratio, release))
    time = uniform_transition_time(tau0, gamma=gamma, damping_ratio=damping_ratio, release=release)
    paper, exact = paper_pulse(tau0, gamma), steady_pulse(tau0, gamma, speed=speed)
    paper_time, paper_length = paper_transition_displacement(tau0, gamma)
    # The value that section IV A prints, which is half of `paper.peak_velocity` in SI units.
    printed_peak = layer.strength_drop / math.sqrt(2.0 * layer.shear_modulus * layer.density)
    paper_peak = layer.convert_from_si(printed_peak, "slip_velocity")
    # In model units: the paper's value, the exact value, and a note on their difference. What the
    # paper calls the stress drop of the pulse is the unit of stress.
    rows = {
        "front_speed_right": (front_speed_undamped(tau0), speed, ""),
        "transition_time": (paper_time, time, TRANSITION_NOTE),
        "transition_length": (paper_length, 2.0 * speed * time, TRANSITION_NOTE),
        "pulse_width": (paper.width, exact.width, ""),
        "pulse_slip": (paper.slip, exact.slip, ""),
        "pulse_peak_velocity": (paper_peak, exact.peak_velocity, PEAK_VELOCITY_NOTE),
        "pulse_stress_drop": (1.0, exact.stress_drop, STRESS_DROP_NOTE),
    }
    table = []
    for name, (paper_value, exact_value, note) in rows.items():
        quantity = QUANTITIES[name]
        paper_in_si = layer.convert_to_si(float(paper_value), quantity)
        exact_in_si = layer.convert_to_si(float(exact_value), quantity)
        table.append((name, UNITS[quantity], paper_in_si, exact_in_si, note))
    columns = ["quantity", "unit", "paper", "exact", "note"]
    return pd.DataFrame(table, columns=columns).set_index("quantity")


def damage_zone_stress_drop(slip, shear_modulus, rock_shear_modulus, thickness, rock_thickness):
    """Return the static stress drop of a fault with a compliant damage zone.

    The zone lies between the fault and stiffer rock. A displacement is imposed on the rock, far
    away from the fault. Source: section IV C 2 of the paper.
    Raises ValueError: outside the ranges below.

    Parameters
    ----------
    slip : float or array, delta (m)
    shear_modulus, rock_shear_modulus : floats or arrays, G of the zone and G_r of the rock (Pa),
        > 0
    thickness, rock_thickness : floats or arrays, H of the zone, > 0, and H_r of the rock, to the
        imposed displacement, >= 0 (m)

    Returns
    -------
    float or array : G delta/(H + (G/G_r) H_r) (Pa)

    Examples
    --------
    >>> float(damage_zone_stress_drop(1.0, 1e9, 3e10, 100.0, 3000.0)) / 1e6
    5.0
    """
    # Shear moduli of the zone and of the rock.
    zone = as_numbers("shear_modulus", shear_modulus, above=0.0)
    rock = as_numbers("rock_shear_modulus", rock_shear_modulus, above=0.0)
    zone_height = as_numbers("thickness", thickness, above=0.0)
    rock_height = as_numbers("rock_thickness", rock_thickness, at_least=0.0)
    # The height of an equally stiff zone without rock.
    total_height = zone_height + zone / rock * rock_height
    return zone * as_numbers("slip", slip) / total_height
