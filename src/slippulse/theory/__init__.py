"""Closed forms and quadratures, without simulation.

They know nothing of the lattice code, so that an agreement of the two means something.
"""
# ruff: noqa: F401 since editors need the names of the first block, which are loaded when used

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    # Absolute imports: the steps do not depend on what is not loaded (`steps.reach`).
    from slippulse.model.balance import prestress_balance_position
    from slippulse.theory.arrest import ArrestingCrack
    from slippulse.theory.barrier import barrier_depth, barrier_depth_estimate
    from slippulse.theory.dimensional import Layer, damage_zone_stress_drop
    from slippulse.theory.exact_transition import (
        ExactTransition,
        exact_transition_displacement,
        uniform_transition_time,
    )
    from slippulse.theory.front_motion import SteadyFront, admissibility_table, steady_front
    from slippulse.theory.front_speeds import (
        continuum_front_speed,
        front_speed,
        lattice_front_speed,
        prestress_for_speed,
        steady_pulse,
    )
    from slippulse.theory.fronts import Fronts, slip_velocity
    from slippulse.theory.pulse import (
        SteadyPulse,
        critical_rate_strengthening,
        front_speed_undamped,
        paper_pulse,
        paper_transition_displacement,
        paper_transition_stress,
    )
    from slippulse.theory.rupture import FrontEnd, Limit, Rupture

_HOMES = {
    "ArrestingCrack": ".arrest",
    "ExactTransition": ".exact_transition",
    "FrontEnd": ".rupture",
    "Fronts": ".fronts",
    "Layer": ".dimensional",
    "Limit": ".rupture",
    "Rupture": ".rupture",
    "SteadyFront": ".front_motion",
    "SteadyPulse": ".pulse",
    "admissibility_table": ".front_motion",
    "barrier_depth": ".barrier",
    "barrier_depth_estimate": ".barrier",
    "continuum_front_speed": ".front_speeds",
    "critical_rate_strengthening": ".pulse",
    "damage_zone_stress_drop": ".dimensional",
    "exact_transition_displacement": ".exact_transition",
    "front_speed": ".front_speeds",
    "front_speed_undamped": ".pulse",
    "lattice_front_speed": ".front_speeds",
    "paper_pulse": ".pulse",
    "paper_transition_displacement": ".pulse",
    "paper_transition_stress": ".pulse",
    "prestress_balance_position": "..model.balance",
    "prestress_for_speed": ".front_speeds",
    "slip_velocity": ".fronts",
    "steady_front": ".front_motion",
    "steady_pulse": ".front_speeds",
    "uniform_transition_time": ".exact_transition",
}
__all__ = [*_HOMES]
__dir__ = __all__.copy


def __getattr__(name: str):
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(_HOMES[name], __name__), name)
