"""Closed forms and quadratures; no simulation. Knows nothing of the lattice code, so that agreement means something."""

from importlib import import_module

_NAMES = {
    "arrest": "ArrestingCrack",
    "dimensional": "Layer damage_zone_stress_drop",
    "barrier": "barrier_depth barrier_depth_estimate",
    "exact_transition": "ExactTransition exact_transition_displacement uniform_transition_time",
    "fronts": "Fronts slip_velocity",
    "front_speeds": "continuum_front_speed front_speed lattice_front_speed prestress_for_speed steady_pulse",
    "front_motion": "SteadyFront admissibility_table steady_front",
    "pulse": "SteadyPulse critical_rate_strengthening front_speed_undamped paper_pulse paper_transition_displacement"
    " paper_transition_stress prestress_balance_position",
    "rupture": "FrontEnd Limit Rupture",
}
_HOMES = {name: home for home, names in _NAMES.items() for name in names.split()}
__all__ = [*_HOMES]
__dir__ = __all__.copy


def __getattr__(name: str):
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
