"""Closed forms and quadratures; no simulation. Knows nothing of the lattice code, so that agreement means something."""

from ..lazy import lazy_names

_HOMES = {
    "ArrestingCrack": "rupture",
    "ExactTransition": "rupture",
    "Fronts": "rupture",
    "Layer": "dimensional",
    "SteadyFront": "front_motion",
    "SteadyPulse": "pulse",
    "admissibility_table": "front_motion",
    "continuum_front_speed": "front_law",
    "damage_zone_stress_drop": "dimensional",
    "exact_transition_displacement": "rupture",
    "front_speed": "front_law",
    "front_speed_undamped": "front_law",
    "lattice_front_speed": "front_law",
    "paper_pulse": "pulse",
    "paper_transition_displacement": "transition",
    "paper_transition_stress": "transition",
    "prestress_balance_position": "transition",
    "prestress_for_speed": "front_law",
    "slip_velocity": "rupture",
    "steady_front": "front_motion",
    "steady_pulse": "pulse",
}
__all__ = list(_HOMES)
__getattr__, __dir__ = lazy_names(__name__, _HOMES)
