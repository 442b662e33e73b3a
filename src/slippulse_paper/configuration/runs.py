"""The runs of a resolved simulation: all combinations of the values in its lists."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any, NamedTuple

from slippulse.model.checks import check_that
from slippulse.model.prestress import Prestress
from slippulse.model.run import Run
from slippulse.model.scene import EXTRA_TERMS

from .chunks import runs_of
from .profiles import TABLES, labels_of, prestress_of


class Entry(NamedTuple):
    """The values of one run, one from each list of a simulation.

    ``dx`` is None if the simulation has no list of spacings. ``damping`` is beta if the simulation
    has a list of beta, and otherwise the damping ratio.
    """

    release: str
    prestress: Prestress
    gamma: float
    dx: float | None
    damping: float
    law: Mapping[str, Any]
    extra_terms: Mapping[str, float]


def runs(simulation: Mapping) -> Iterator[Run]:
    """Yield the runs of a resolved simulation, or of one chunk of it."""
    for index, entry in enumerate(entries(simulation)):
        dx = _spacing(simulation, entry, index)
        yield Run(
            boundary=simulation["boundary"],
            prestress=entry.prestress,
            gamma=entry.gamma,
            dx=dx,
            beta=entry.damping if "beta" in simulation else entry.damping * dx,
            release=entry.release,
            friction=entry.law,
            extra_terms=entry.extra_terms,
        )


def parameters(simulation: Mapping) -> Iterator[dict[str, Any]]:
    """Yield the parameters of each run by name."""
    for run in runs(simulation):
        yield {**run.parameters(), **vars(run.prestress), "damping_ratio": run.damping_ratio}


def entries(simulation: Mapping) -> Iterator[Entry]:
    """Yield the values of each run of a resolved simulation, or of one chunk of it."""
    for release, *shape, gamma, dx, damping, law, extra_terms in _combinations(simulation):
        if "profiles" in simulation:
            profile = prestress_of(shape[0])
        else:
            left, right, width, steps = shape
            profile = Prestress(left, left if right is None else right, width, steps=steps)
        yield Entry(release, profile, gamma, dx, damping, law, extra_terms)


def profile_labels(simulation: Mapping) -> list[dict[str, float]]:
    """Return number and seed of the profile of each run, or an empty list if none has a table."""
    profiles = simulation.get("profiles", [])
    if not any(key in profile for profile in profiles for key in TABLES):
        return []
    labels = dict(zip(map(id, profiles), labels_of(profiles), strict=True))
    return [labels[id(profile)] for _, profile, *_ in _combinations(simulation)]


def _combinations(simulation: Mapping) -> Iterator[tuple]:
    """Yield the entries of the lists for each run of a simulation, or of one chunk of it."""
    chunk = simulation.get("chunk")
    runs_in_chunk = set(runs_of(chunk[0], chunk[1], run_count(simulation))) if chunk else None
    for number, combination in enumerate(product(*_axes(simulation))):
        if runs_in_chunk is None or number in runs_in_chunk:
            yield combination


def run_count(simulation: Mapping) -> int:
    """Return the number of runs: the product of the lengths of the lists of a simulation."""
    return math.prod(map(len, _axes(simulation)))


def _axes(simulation: Mapping) -> list[Sequence]:
    """Return the lists of a simulation. Its runs are all combinations of their entries."""
    release = simulation["release"]
    releases = [release] if isinstance(release, str) else release
    if "profiles" in simulation:
        shapes = [simulation["profiles"]]
    else:
        right, rule = simulation["right"], simulation.get("beyond")
        # Each level of `beyond` is a step of the pre-stress at the position where it begins.
        steps = [((rule["position"], level),) for level in rule["levels"]] if rule else [()]
        rights = [None] if right == "same" else right
        shapes = [simulation["left"], rights, simulation["width"], steps]
    gamma, dx = simulation.get("gamma", [0.0]), simulation.get("dx", [None])
    damping = simulation.get("beta", simulation["damping_ratio"])
    laws = simulation.get("friction", [{"law": "coulomb"}])
    coefficients = [simulation.get(name, [term.default]) for name, term in EXTRA_TERMS.items()]
    extra_terms = [dict(zip(EXTRA_TERMS, values, strict=True)) for values in product(*coefficients)]
    return [releases, *shapes, gamma, dx, damping, laws, extra_terms]


def _spacing(simulation: Mapping, entry: Entry, index: int) -> float:
    """Return the spacing of the run with a number, from 0.

    It is fixed, promised for an accuracy, given in a list, or follows from the rule in ``spacing``.
    """
    rule = simulation["spacing"]
    if "fixed" in rule:
        return float(rule["fixed"])
    spacing = simulation["spacings"][index] if "spacings" in simulation else entry.dx
    if spacing is None:
        width = entry.prestress.width
        has_width = width is not None or rule["width_power"] == 0.0
        allowed = "0 for a profile without a width"
        check_that(has_width, "spacing.width_power", rule["width_power"], allowed)
        powers = (width or 1.0) ** rule["width_power"] * entry.gamma ** rule["gamma_power"]
        spacing = simulation["accuracy"]["dx"] * rule["scale"] * powers
    # With twelve digits, a spacing of 0.02 is exactly 0.02 in the data and in labels.
    return float(f"{simulation['coarser'] * spacing:.12g}")
