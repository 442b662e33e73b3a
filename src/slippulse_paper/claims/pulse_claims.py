"""Judge claims about pulses on lattices: equations, uniqueness and stability.

`equation` and `always` evaluate the rules of manuscript/claims.yaml. The other functions take the
evidence and the id of their claim, and return the result.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain, combinations
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from . import rules
from .evidence import Evidence, agreed_answers, value_of
from .kinds import Approximate, Equation, Qualitative

TWO_WAY = "pulses, two-way"
VELOCITY_CHANGE, HALF_WIDTH = "largest_velocity_change", "pulse_half_width"
WITHOUT_DAMPING = "damping_ratio == 0"
# Simulations of pulses that enter another pre-stress, and of pulses in a uniform one.
PERTURBED = ("pulses_across_a_step", "pulses_across_wide_steps", "pulses_perturbed_elsewhere")
UNPERTURBED = ("any_prestress", "steady_displacement", "steady_elsewhere")


def equation(
    evidence: Evidence, id: str, measured: str, predicted: str, runs: Mapping[str, str]
) -> Equation:
    """Judge an equation between columns, by a rule of manuscript/claims.yaml."""
    tables = [evidence.finest(name, where=where) for name, where in runs.items()]
    return evidence.equation(id, pd.concat(tables), measured, predicted)


class Always(NamedTuple):
    """A rule of manuscript/claims.yaml: a condition that must hold in each run of some sweeps."""

    sweeps: Sequence[str]
    where: str = ""
    holds: str = ""
    decidable: str = ""
    ends: Sequence[str] = ()
    counted: Mapping[str, str] = {}
    numbers: Mapping[str, str] = {}


def always(evidence: Evidence, id: str, **keys: Any) -> Qualitative:
    """Judge a claim that has a rule `Always`."""
    rule = Always(**keys)
    holds = rule.holds.format(tolerance=evidence.tolerance(id), steady=evidence.steady)
    holds = holds or f"regime in {rule.ends}"
    decided = [
        evidence.agreed(sweep, rule.where, holds, rule.decidable, rule.ends)
        for sweep in rule.sweeps
    ]
    table = evidence.tables[rule.sweeps[0]]
    further = {words: float(value_of(table, number)) for words, number in rule.numbers.items()}
    for words, condition in rule.counted.items():
        regimes = evidence.finest(*rule.sweeps, where=condition)["regime"].value_counts()
        further |= {f"{words}: {regime}": float(count) for regime, count in regimes.items()}
    return Qualitative(decided=[*chain.from_iterable(decided)], further=further)


def change_signs(table: pd.DataFrame) -> dict[str, pd.Series]:
    """Return the signs of the changes of velocity and half-width: 1, -1, or 0 for no change.

    Each pulse is compared with the pulse that began in the same pre-stress and stays at level 0.
    """
    began = table[table["beyond"] == 0.0].set_index("left")
    change, still = table[VELOCITY_CHANGE], table["left"].map(began[VELOCITY_CHANGE])
    wider = table[HALF_WIDTH] - table["left"].map(began[HALF_WIDTH])
    signs = {
        "changed": np.sign(change).where(change.abs() > still.abs(), 0.0),
        "widened": np.sign(wider),
    }
    # A pulse that has died out counts as decayed.
    gone = table["regime"] == "arrested"
    return {name: sign.mask(gone, -1.0).fillna(0.0) for name, sign in signs.items()}


def front_speed_moderate_gamma(evidence: Evidence, id: str) -> Approximate:
    """Compare the front speed without damping for gamma up to 1 with the formula."""
    where = f"{WITHOUT_DAMPING} and 0.1 <= gamma <= 1"
    tables = evidence.lattices("speed_against_gamma", "steady_displacement", where=where)
    return evidence.approximate(id, tables, "front_speed_right", "paper_front_speed_right")


def thin_layer(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether the thickness, which is 1, is much smaller than each steady pulse width."""
    table = evidence.finest("any_prestress")
    width, slowest = table["pulse_width"], table["front_speed_right"].min()
    further = {"narrowest pulse, in H": width.min(), "widest pulse": width.max()}
    further["slowest front, over the fastest wave"] = slowest
    allowed = evidence.tolerance(id)
    thin = 1.0 / width <= allowed
    template_values: dict = {name: sorted({*table[name]}) for name in ("gamma", "damping_ratio")}
    template_values["largest"] = (np.pi * allowed) ** 2
    return Qualitative(
        decided=thin, failing=rules.UNMET, further=further, template_values=template_values
    )


def within(
    deviation: np.ndarray, uncertainty: np.ndarray, allowed: float, sure: bool = False
) -> bool | None:
    """Return True if all deviations are allowed, False if one is not, None if that is open.

    If ``sure``, every deviation must be allowed together with its uncertainty.
    """
    if np.any(deviation - uncertainty > allowed):
        return False
    return True if np.all(deviation + sure * uncertainty <= allowed) else None


def differences_of_pairs(
    table: pd.DataFrame, sizes: list[str]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield relative differences of sizes, with uncertainties, for each pair of runs."""
    values = table[sizes].to_numpy()
    uncertainties = table[[f"uncertainty_{size}" for size in sizes]].to_numpy()
    for first, second in combinations(range(len(table)), 2):
        uncertainty = uncertainties[first] + uncertainties[second]
        deviation = np.abs(values[first] / values[second] - 1.0)
        yield deviation, uncertainty / np.abs(values[second])


def displacement_pulse_unique(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether pulses in the same pre-stress that began differently are the same pulse."""
    table = evidence.finest("nucleation_widths", "any_prestress", "steady_elsewhere", *PERTURBED)
    sizes, allowed = ["pulse_peak_velocity", "pulse_width", "pulse_slip"], evidence.tolerance(id)
    decided: list[bool | None] = []
    for _, rows in table.groupby(["beyond", "gamma", "damping_ratio"]):
        decided += [within(*pair, allowed) for pair in differences_of_pairs(rows, sizes)]
    return Qualitative(decided=decided)


def perturbed_pulses_settle(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether a pulse that enters another pre-stress leaves the slip of its steady pulse."""
    keys = ["left", "gamma", "damping_ratio"]
    slips = {
        "slip off by at most": "pulse_slip",
        "slip off the exact slip by at most": "exact_pulse_slip",
        "slip off that without damping by at most": "paper_pulse_slip",
    }
    deviations = []
    perturbed, unperturbed = evidence.lattices(*PERTURBED), evidence.lattices(*UNPERTURBED)
    for table, alone in zip(perturbed, unperturbed, strict=True):
        steady = alone.drop_duplicates(keys).set_index(keys)[[*slips.values()]]
        steady = steady.reindex(pd.MultiIndex.from_frame(table[["beyond", *keys[1:]]]))
        deviations.append((table[["pulse_slip"]].to_numpy() / steady - 1.0).abs())
    settled = [table["pulse_slip"] <= evidence.tolerance(id) for table in deviations[:2]]
    largest = deviations[0].max().fillna(0.0)
    further = {words: float(largest[slip]) for words, slip in slips.items()}
    return Qualitative(decided=agreed_answers(*settled), further=further)


def zero_net_stress_change(evidence: Evidence, id: str) -> Equation:
    """Judge whether a pulse that keeps its shape leaves no strain, and others grow or decay."""
    strain = evidence.finest("regimes_beyond", where="beyond != 0")["strain_left"].to_numpy()
    changes = evidence.agreed("regimes_beyond", "beyond != 0", "changed != 0")

    def straining(tolerance: float) -> Qualitative:
        return Qualitative(decided=np.array(changes, object)[strain > tolerance])

    table = evidence.finest("stress_pulses", where=WITHOUT_DAMPING)
    claim = evidence.equation(id, table, "strain_left", "0")
    counts = straining(claim.tolerance).counts()
    return replace(claim, counts=counts, extra_verdict=lambda allowed: straining(allowed).verdict())


def stress_pulse_not_unique(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether different pre-stress makes different pulses in a region of zero pre-stress."""
    table = evidence.finest("stress_pulses", where="damping_ratio > 0")
    # The smallest nonzero damping ratio is that of the figures; without damping the lattice rings.
    table = table[table["damping_ratio"] == table["damping_ratio"].min()]
    allowed, decided = evidence.tolerance(id), []
    for deviation, uncertainty in differences_of_pairs(table, ["pulse_peak_velocity", HALF_WIDTH]):
        alike = within(deviation, uncertainty, allowed, sure=True)
        decided.append(None if alike is None else not alike)
    return Qualitative(decided=decided)


def stress_pulse_set_by_prestress(evidence: Evidence, id: str) -> Qualitative:
    """Compare peak and half-width on damped lattices with the exact solution."""
    table = evidence.finest("stress_pulses", where="damping_ratio > 0")
    allowed = evidence.tolerance(id)
    exact = table[["exact_largest_velocity", "exact_half_width"]].to_numpy()
    deviation = (table[["pulse_peak_velocity", HALF_WIDTH]] / exact - 1.0).abs()
    uncertainty = table[[f"uncertainty_{name}" for name in deviation]].to_numpy() / exact
    rows = zip(deviation.to_numpy(), uncertainty, strict=True)
    decided = [within(*row, allowed) for row in rows]
    peak, half_width = deviation.max()
    words = "on the lattice, with damping, off by at most"
    further = {f"peak {words}": float(peak), f"half-width {words}": float(half_width)}
    return Qualitative(decided=decided, further=further)
