"""Closed forms and quadratures; no simulation. Knows nothing of the lattice code, so that agreement means something."""

from ..model.lazy import lazy_names

_HOMES = {
    "ArrestingCrack": "arrest",
    "ExactTransition": "exact_transition",
    "FrontEnd": "rupture",
    "Fronts": "exact_transition",
    "Layer": "dimensional",
    "Limit": "rupture",
    "Rupture": "rupture",
    "SteadyFront": "front_motion",
    "SteadyPulse": "pulse",
    "admissibility_table": "front_motion",
    "barrier_depth": "slow_front",
    "barrier_depth_estimate": "slow_front",
    "continuum_front_speed": "front_law",
    "critical_rate_strengthening": "pulse",
    "damage_zone_stress_drop": "dimensional",
    "exact_transition_displacement": "exact_transition",
    "front_speed": "front_law",
    "front_speed_undamped": "pulse",
    "lattice_front_speed": "front_law",
    "paper_pulse": "pulse",
    "paper_transition_displacement": "pulse",
    "paper_transition_stress": "pulse",
    "prestress_balance_position": "pulse",
    "prestress_for_speed": "front_law",
    "slip_velocity": "exact_transition",
    "steady_front": "front_motion",
    "steady_pulse": "front_law",
    "uniform_transition_time": "exact_transition",
}
__all__ = list(_HOMES)
__getattr__, __dir__ = lazy_names(__name__, _HOMES)
