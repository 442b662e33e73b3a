"""Closed forms and quadratures; no simulation. Knows nothing of the lattice code, so that agreement means something."""

from .dimensional import damage_zone_stress_drop
from .front_speed import (
    front_speed,
    front_speed_undamped,
    lattice_front_speed,
    prestress_for_speed,
)
from .pulse import SteadyPulse, paper_pulse, steady_pulse
from .transition import (
    paper_transition_displacement,
    paper_transition_stress,
    prestress_balance_position,
)

__all__ = [
    "SteadyPulse",
    "damage_zone_stress_drop",
    "front_speed",
    "front_speed_undamped",
    "lattice_front_speed",
    "paper_pulse",
    "paper_transition_displacement",
    "paper_transition_stress",
    "prestress_balance_position",
    "prestress_for_speed",
    "steady_pulse",
]
