"""Figure 8: slip, slip velocity and acceleration of the steady pulses, displacement boundary, with theory."""

from .shared.pulses import plot_fields as plot
from .shared.pulses import pulse_table as table

__all__ = ["NEEDS", "plot", "table"]

NEEDS = {
    "data": ["steady_displacement"],
    "measured": ["steady_displacement"],
    "predicted": {"steady_displacement": ["pulse"]},
    "studies": ["pulse_profiles"],
    "settings": ["measure.front_window"],
}
