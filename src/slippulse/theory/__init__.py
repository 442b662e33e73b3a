"""Closed forms and quadratures, without simulation.

They know nothing of the lattice code, so that an agreement of the two means something.
"""

from importlib import import_module

_HOMES = {
    "ArrestingCrack": ".arrest",
    "ExactTransition": ".fronts",
    "FrontEnd": ".rupture",
    "Limit": ".rupture",
    "Rupture": ".rupture",
    "SteadyPulse": ".closed_pulse",
    "SteadyRupture": ".friction_laws",
    "barrier_depth": ".barrier",
    "barrier_depth_estimate": ".barrier",
    "continuum_front_speed": ".front_speeds",
    "critical_rate_strengthening": ".closed_pulse",
    "damage_zone_stress_drop": ".dimensional",
    "exact_transition_displacement": ".exact_transition",
    "front_speed": ".front_speeds",
    "front_speed_undamped": ".front_speeds",
    "lattice_front_speed": ".front_speeds",
    "paper_pulse": ".closed_pulse",
    "paper_transition_displacement": ".closed_pulse",
    "paper_transition_stress": ".closed_pulse",
    "prestress_balance_position": "..model.balance",
    "prestress_for_speed": ".front_speeds",
    "rate_pulse": ".friction_laws",
    "steady_pulse": ".pulse",
    "uniform_transition_time": ".exact_transition",
    "weakening_pulse": ".friction_laws",
}
__all__ = [*_HOMES]
__dir__ = __all__.copy


def __getattr__(name: str):
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name], __name__), name)
