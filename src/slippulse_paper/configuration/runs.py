"""The runs of a resolved simulation, plain builtins. Every job imports this module."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any

from slippulse.model.checks import check_that
from slippulse.model.prestress import Prestress
from slippulse.model.run import Run
from slippulse.model.scene import EXTRA_TERMS

from .chunks import runs_of
from .profiles import TABLES, labels_of, prestress_of


def runs(simulation: Mapping) -> Iterator[Run]:
    """The runs of a resolved simulation, or of a chunk of it, one after the other."""
    for index, entry in enumerate(entries(simulation)):
        release, profile, gamma, given, damping, law, extra_terms = entry
        dx = _spacing(simulation, profile, gamma, given, index)
        beta = damping if "beta" in simulation else damping * dx
        boundary = simulation["boundary"]
        yield Run(boundary, profile, gamma, dx, beta, release, law, extra_terms)


def parameters(simulation: Mapping) -> Iterator[dict[str, Any]]:
    """The parameters of each run by name."""
    for run in runs(simulation):
        yield {**run.parameters(), **vars(run.prestress), "damping_ratio": run.damping_ratio}


def entries(simulation: Mapping) -> Iterator[tuple]:
    """One entry of each list, for each run.

    These are the release rule, the pre-stress, gamma, the spacing or None, the damping, the law of
    friction, and the coefficients of the extra terms by name.
    """
    for release, *shape, gamma, dx, damping, law, extra_terms in _combinations(simulation):
        if "profiles" in simulation:
            profile = prestress_of(shape[0])
        else:
            left, right, width, steps = shape
            profile = Prestress(left, left if right is None else right, width, steps=steps)
        yield release, profile, gamma, dx, damping, law, extra_terms


def profile_labels(simulation: Mapping) -> list[dict[str, float]]:
    """Number and seed of the profile of each run; nothing if no profile has a table."""
    profiles = simulation.get("profiles", [])
    if not any(key in profile for profile in profiles for key in TABLES):
        return []
    labels = dict(zip(map(id, profiles), labels_of(profiles), strict=True))
    return [labels[id(profile)] for _, profile, *_ in _combinations(simulation)]


def _combinations(simulation: Mapping) -> Iterator[tuple]:
    """The entries of the lists, for each run of a simulation or of a chunk of it."""
    chunk = simulation.get("chunk")
    wanted = set(runs_of(chunk[0], chunk[1], run_count(simulation))) if chunk else None
    for number, combination in enumerate(product(*_axes(simulation))):
        if wanted is None or number in wanted:
            yield combination


def run_count(simulation: Mapping) -> int:
    """Number of runs of a resolved simulation, the product of the lengths of its lists."""
    return math.prod(map(len, _axes(simulation)))


def _axes(simulation: Mapping) -> list[Sequence]:
    """The lists whose product the runs are."""
    release = simulation["release"]
    releases = [release] if isinstance(release, str) else release
    if "profiles" in simulation:
        shapes = [simulation["profiles"]]
    else:
        right, rule = simulation["right"], simulation.get("beyond")
        # Each level is one step, at the position from which the level holds.
        steps = [((rule["position"], level),) for level in rule["levels"]] if rule else [()]
        rights = [None] if right == "same" else right
        shapes = [simulation["left"], rights, simulation["width"], steps]
    gamma, dx = simulation.get("gamma", [0.0]), simulation.get("dx", [None])
    damping = simulation.get("beta", simulation["damping_ratio"])
    laws = simulation.get("friction", [{"law": "coulomb"}])
    coefficients = [simulation.get(name, [term.default]) for name, term in EXTRA_TERMS.items()]
    extra_terms = [dict(zip(EXTRA_TERMS, values, strict=True)) for values in product(*coefficients)]
    return [releases, *shapes, gamma, dx, damping, laws, extra_terms]


def _spacing(
    simulation: Mapping, profile: Prestress, gamma: float, given: float | None, index: int
) -> float:
    """Spacing of a run: fixed, promised, given in a list, or by the rule of the simulation."""
    rule = simulation["spacing"]
    if "fixed" in rule:
        return float(rule["fixed"])
    spacing = simulation["spacings"][index] if "spacings" in simulation else given
    if spacing is None:
        known = profile.width is not None or rule["width_power"] == 0.0
        allowed = "0 for a profile without a width"
        check_that(known, "spacing.width_power", rule["width_power"], allowed)
        powers = (profile.width or 1.0) ** rule["width_power"] * gamma ** rule["gamma_power"]
        spacing = simulation["accuracy"]["dx"] * rule["scale"] * powers
    # Twelve digits: a spacing of 0.02 is 0.02 in the data and on a label.
    return float(f"{simulation['coarser'] * spacing:.12g}")
