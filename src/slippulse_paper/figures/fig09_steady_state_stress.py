"""Figure 9: slip, slip velocity and acceleration of the pulses under a stress boundary."""

from .shared.pulse_panels import plot_fields, pulse_table

draw, table = plot_fields, pulse_table
NEEDS = {
    "data": ["steady_stress"],
    "measured": {"steady_stress": ["transition"]},
    "studies": ["pulse_profiles"],
    "settings": ["measure.front_window"],
}
