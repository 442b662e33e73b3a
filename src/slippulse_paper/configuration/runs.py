"""The runs of a resolved simulation: all combinations of the values in its lists."""

import math
from collections.abc import Collection, Iterator, Mapping
from itertools import product
from typing import Any, NamedTuple

from slippulse.model.checks import check_that
from slippulse.model.prestress import Prestress
from slippulse.model.run import Run
from slippulse.model.scene import EXTRA_TERMS

from .chunks import runs_of
from .profiles import TABLE_KEYS, ExpandedProfiles, labels_of, prestress_of

# The value of `right` for which both levels are equal.
SAME = "same"


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
        # The damping of an entry is beta or, without a list of beta, the damping ratio beta/dx.
        beta = entry.damping if "beta" in simulation else entry.damping * dx
        yield Run(
            boundary=simulation["boundary"],
            prestress=entry.prestress,
            gamma=entry.gamma,
            dx=dx,
            beta=beta,
            release=entry.release,
            friction=entry.law,
            extra_terms=entry.extra_terms,
        )


def parameters(simulation: Mapping) -> Iterator[dict[str, Any]]:
    """Yield the parameters of each run by name, with those of its pre-stress."""
    for run in runs(simulation):
        yield {**run.parameters(), **vars(run.prestress), "damping_ratio": run.damping_ratio}


def entries(simulation: Mapping) -> Iterator[Entry]:
    """Yield the values of each run of a resolved simulation, or of one chunk of it."""
    for values in _combinations(simulation, _axes(simulation)):
        yield Entry(
            release=values["release"],
            prestress=_prestress(values),
            gamma=values["gamma"],
            dx=values["dx"],
            damping=values["damping"],
            law=values["law"],
            extra_terms=values["extra_terms"],
        )


def _prestress(values: Mapping[str, Any]) -> Prestress:
    """Return the pre-stress of a run from its profile, or from its levels, width and steps."""
    if "profile" in values:
        return prestress_of(values["profile"])
    left, right = values["left"], values["right"]
    if right == SAME:
        right = left
    return Prestress(left, right, values["width"], steps=values["steps"])


def profile_labels(simulation: Mapping) -> list[dict[str, float]]:
    """Return for each run the number of its profile (profile) and its seed.

    The list is empty if no profile of the simulation has a table of pre-stress.
    """
    profiles = simulation.get("profiles", [])
    if not any(TABLE_KEYS.intersection(profile) for profile in profiles):
        return []
    # Put labels in place of the profiles. Each combination then has the label of its profile.
    axes = _axes(simulation) | {"profile": labels_of(ExpandedProfiles(profiles))}
    return [values["profile"] for values in _combinations(simulation, axes)]


def _combinations(simulation: Mapping, axes: Mapping[str, Collection]) -> Iterator[dict[str, Any]]:
    """Yield the values of each run of a simulation, or of one chunk of it, by name.

    axes : lists of values by name, from `_axes`
    """
    chunk = simulation.get("chunk")
    runs_in_chunk = None
    if chunk is not None:
        chunk_number, chunk_count = chunk
        runs_in_chunk = set(runs_of(chunk_number, chunk_count, run_count(simulation)))
    for run, combination in enumerate(product(*axes.values())):
        if runs_in_chunk is None or run in runs_in_chunk:
            yield dict(zip(axes, combination, strict=True))


def run_count(simulation: Mapping) -> int:
    """Return the number of runs: the product of the lengths of the lists of a simulation."""
    return math.prod(map(len, _axes(simulation).values()))


def _axes(simulation: Mapping) -> dict[str, Collection]:
    """Return the lists of a simulation by name. Each combination of their entries is a run."""
    # A list that is not given has one entry: its default, or None if something else sets the value.
    # The damping is the list of beta, or that of the damping ratio if there is no list of beta.
    release = simulation["release"]
    releases = [release] if isinstance(release, str) else release
    return {
        "release": releases,
        **_prestress_axes(simulation),
        "gamma": simulation.get("gamma", [0.0]),
        "dx": simulation.get("dx", [None]),
        "damping": simulation.get("beta", simulation["damping_ratio"]),
        "law": simulation.get("friction", [{"law": "coulomb"}]),
        "extra_terms": _extra_terms(simulation),
    }


def _extra_terms(simulation: Mapping) -> list[dict[str, float]]:
    """Return all combinations of the coefficients of extra terms, each by name."""
    coefficients = [simulation.get(name, [term.default]) for name, term in EXTRA_TERMS.items()]
    return [dict(zip(EXTRA_TERMS, values, strict=True)) for values in product(*coefficients)]


def _prestress_axes(simulation: Mapping) -> dict[str, Collection]:
    """Return the lists of a simulation that give its pre-stress, by name."""
    if "profiles" in simulation:
        return {"profile": ExpandedProfiles(simulation["profiles"])}
    right, second_level = simulation["right"], simulation.get("beyond")
    # Each entry has the steps of one run. By default there are none.
    steps: list[tuple] = [()]
    if second_level is not None:
        # The pre-stress of each run has one step, to one of the levels.
        steps = [((second_level["position"], level),) for level in second_level["levels"]]
    return {
        "left": simulation["left"],
        "right": [SAME] if right == SAME else right,
        "width": simulation["width"],
        "steps": steps,
    }


def _spacing(simulation: Mapping, entry: Entry, index: int) -> float:
    """Return the block spacing of a run.

    If the key ``spacing`` of the simulation has a fixed value, all lattices have this spacing. If
    not, the spacing is multiplied by the factor ``coarser`` on the coarser lattices of a grid
    study.

    index : number of the run, from 0
    """
    rule = simulation["spacing"]
    if "fixed" in rule:
        return float(rule["fixed"])
    if "spacings" in simulation:
        # The list of `with_promised_spacings`, with the spacing of each run for an accuracy that
        # the user requires.
        spacing = simulation["spacings"][index]
    elif entry.dx is not None:
        # The simulation has a list ``dx``.
        spacing = entry.dx
    else:
        # The preset has a spacing, which the rule adapts to the run.
        spacing = _scaled_spacing(simulation["accuracy"]["dx"], rule, entry)
    # Rounding errors of the product would show in the data and in labels.
    return float(f"{simulation['coarser'] * spacing:.12g}")


def _scaled_spacing(dx: float, rule: Mapping, entry: Entry) -> float:
    """Return the block spacing dx * scale * W^width_power * gamma^gamma_power.

    ``dx`` is the spacing of the preset, and the rule has the scale and the powers. Raises
    ValueError if the spacing depends on the width W of the Gaussian, but the profile has none.
    """
    width, width_power = entry.prestress.width, rule["width_power"]
    is_allowed = width is not None or width_power == 0.0
    allowed = "0, because this profile has no width"
    check_that(is_allowed, "spacing.width_power", width_power, allowed)
    width_factor = 1.0 if width is None else width**width_power
    return dx * rule["scale"] * (width_factor * entry.gamma ** rule["gamma_power"])
