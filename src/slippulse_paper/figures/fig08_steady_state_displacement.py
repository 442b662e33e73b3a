"""Figure 8: slip, slip velocity and acceleration of steady pulses under a displacement boundary."""

from .shared.pulse_panels import plot_fields, pulse_table

draw, table = plot_fields, pulse_table
NEEDS = {
    "data": ["steady_displacement"],
    "measured": {"steady_displacement": ["pulse"]},
    "studies": ["pulse_profiles"],
    "settings": ["measure.front_window"],
}
# Runs of each simulation that the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "steady_displacement": "`boundary: displacement` and a level > 0",
}
