"""Figure 9: slip, slip velocity and acceleration of steady pulses under a stress boundary."""

from .shared.pulse_panels import plot_fields, pulse_table

draw, table = plot_fields, pulse_table
NEEDS = {
    "data": ["steady_stress"],
    "measured": {"steady_stress": ["transition"]},
    "studies": ["pulse_profiles"],
    "settings": ["measure.front_window"],
}
# Runs of each simulation that the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "steady_stress": "`boundary: stress`, left level < 0, right level 0, no steps",
}
