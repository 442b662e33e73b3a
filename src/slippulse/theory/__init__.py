"""Closed forms and quadratures; no simulation. Knows nothing of the lattice code, so that agreement means something."""

from .arrest import ArrestingCrack
from .barrier import barrier_depth, barrier_depth_estimate
from .dimensional import Layer, damage_zone_stress_drop
from .exact_transition import (
    ExactTransition,
    Fronts,
    exact_transition_displacement,
    slip_velocity,
    uniform_transition_time,
)
from .front_speed import (
    front_speed,
    front_speed_undamped,
    lattice_front_speed,
    prestress_for_speed,
)
from .pulse import SteadyPulse, paper_pulse, steady_pulse
from .rupture import FrontEnd, Limit, Rupture
from .transition import (
    paper_transition_displacement,
    paper_transition_stress,
    prestress_balance_position,
)

__all__ = [
    "ArrestingCrack",
    "ExactTransition",
    "FrontEnd",
    "Fronts",
    "Layer",
    "Limit",
    "Rupture",
    "SteadyPulse",
    "barrier_depth",
    "barrier_depth_estimate",
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
    "uniform_transition_time",
]
