"""Block spacings with which the runs of a simulation reach a required accuracy."""

import math
from collections.abc import Mapping
from typing import Any

from slippulse.model.checks import check_that
from slippulse.model.scene import refuse_extra_terms
from slippulse.simulation.accuracy import settings_for

from .runs import entries


def with_promised_spacings(simulation: Mapping) -> Mapping[str, Any]:
    """Add a list ``spacings`` to a resolved simulation if the user requires an accuracy.

    The list has the block spacing with which each run reaches the accuracy. Without a required
    accuracy, the simulation is returned as it is. Raises ValueError if no accuracy can be promised
    for the scheme or the friction of the simulation.
    """
    promise = simulation["accuracy"].get("promise")
    if promise is None:
        return simulation
    # With other schemes, the time step causes an error that a grid study does not show.
    scheme = simulation["scheme"]
    check_that(scheme == "localised", "scheme", scheme, "'localised' if accuracy is given")
    # NaN means that the simulation sets its own spacing, or beta in place of the damping ratio.
    if math.isnan(promise):
        return simulation
    laws = simulation.get("friction", [])
    # `settings_for` assumes Coulomb friction. With other laws, a pulse may grow for ever, or have
    # no width.
    is_coulomb = all(law["law"] == "coulomb" for law in laws)
    condition = "if accuracy is given and the simulation has no dx of its own"
    check_that(is_coulomb, "friction", laws, f"law coulomb {condition}")
    spacings = []
    for entry in entries(simulation):
        refuse_extra_terms(entry.extra_terms, condition)
        settings = settings_for(
            promise,
            boundary=simulation["boundary"],
            prestress=entry.prestress,
            gamma=entry.gamma,
            # This is the damping ratio, since simulations with beta > 0 have returned above.
            damping_ratio=entry.damping,
            release=entry.release,
            fields="fields" in simulation["record"],
        )
        spacings.append(settings["dx"])
    return {**simulation, "spacings": spacings}
