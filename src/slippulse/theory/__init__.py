"""Closed forms and quadratures; no simulation. Knows nothing of the lattice code, so that agreement means something."""

from .dimensional import Layer, damage_zone_stress_drop
from .front_speed import (
    front_speed,
    front_speed_undamped,
    lattice_front_speed,
    prestress_for_speed,
)
from .pulse import SteadyPulse, paper_pulse, steady_pulse
from .rupture import (
    ArrestingCrack,
    ExactTransition,
    Fronts,
    exact_transition_displacement,
    slip_velocity,
)
from .transition import (
    paper_transition_displacement,
    paper_transition_stress,
    prestress_balance_position,
)

__all__ = [
    "ArrestingCrack",
    "ExactTransition",
    "Fronts",
    "Layer",
    "SteadyPulse",
    "damage_zone_stress_drop",
    "exact_transition_displacement",
    "front_speed",
    "front_speed_undamped",
    "lattice_front_speed",
    "paper_pulse",
    "paper_transition_displacement",
    "paper_transition_stress",
    "prestress_balance_position",
    "prestress_for_speed",
    "slip_velocity",
    "steady_pulse",
]
