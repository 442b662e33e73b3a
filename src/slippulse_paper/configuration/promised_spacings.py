"""Spacings of the runs of a simulation for which an accuracy is promised."""

import math
from collections.abc import Mapping
from typing import Any

from slippulse.model.checks import check_that
from slippulse.model.scene import refuse_extra_terms
from slippulse.simulation.accuracy import settings_for

from .runs import entries


def promised(simulation: Mapping) -> Mapping[str, Any]:
    """Add the spacing of each run where an accuracy is promised, or raise ValueError."""
    promise, scheme = simulation["accuracy"].get("promise"), simulation["scheme"]
    if promise is None:
        return simulation
    # A grid study does not see the error of another scheme's step.
    check_that(scheme == "localised", "scheme", scheme, "'localised' where accuracy is given")
    if math.isnan(promise):
        return simulation
    laws = simulation.get("friction", [])
    # The constants hold for it alone. Other laws have pulses without a width, or that diverge.
    coulomb = all(law["law"] == "coulomb" for law in laws)
    check_that(coulomb, "friction", laws, "law coulomb where accuracy is given, or a dx of its own")
    common = {"boundary": simulation["boundary"], "fields": "fields" in simulation["record"]}
    spacings = []
    for release, prestress, gamma, _, damping_ratio, _, extra_terms in entries(simulation):
        refuse_extra_terms(extra_terms, "where accuracy is given, or a dx of its own")
        common |= {"release": release, "gamma": gamma, "damping_ratio": damping_ratio}
        spacings.append(settings_for(promise, prestress=prestress, **common)["dx"])
    return {**simulation, "spacings": spacings}
