"""Spacings of the runs of a simulation for which an accuracy is promised."""

import math
from collections.abc import Mapping
from typing import Any

from slippulse.model.checks import check_that
from slippulse.model.scene import refuse_extra_terms
from slippulse.simulation.accuracy import settings_for

from .runs import entries


def promised(simulation: Mapping) -> Mapping[str, Any]:
    """Return a simulation with the spacing of each run, if an accuracy is promised for it.

    Raises ValueError if no accuracy can be promised for its scheme or its friction.
    """
    promise = simulation["accuracy"].get("promise")
    if promise is None:
        return simulation
    # With other schemes the time step has an error that a grid study does not show.
    scheme = simulation["scheme"]
    check_that(scheme == "localised", "scheme", scheme, "'localised' if accuracy is given")
    # NaN means that the simulation sets its own spacing.
    if math.isnan(promise):
        return simulation
    laws = simulation.get("friction", [])
    # The constants of `settings_for` hold for Coulomb friction. With other laws a pulse may diverge
    # or have no width.
    coulomb = all(law["law"] == "coulomb" for law in laws)
    condition = "if accuracy is given and the simulation has no dx of its own"
    check_that(coulomb, "friction", laws, f"law coulomb {condition}")
    spacings = []
    for entry in entries(simulation):
        refuse_extra_terms(entry.extra_terms, condition)
        settings = settings_for(
            promise,
            boundary=simulation["boundary"],
            prestress=entry.prestress,
            gamma=entry.gamma,
            damping_ratio=entry.damping,
            release=entry.release,
            fields="fields" in simulation["record"],
        )
        spacings.append(settings["dx"])
    return {**simulation, "spacings": spacings}
