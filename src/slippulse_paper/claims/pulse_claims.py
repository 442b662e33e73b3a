"""Claims about pulses on lattices: equations, uniqueness and stability."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import chain, combinations
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from . import rules
from .evidence import Evidence, agreeing, value_of
from .kinds import Approximate, Equation, Qualitative

TWO_WAY = "pulses, two-way"
CHANGE, HALF_WIDTH = "largest_velocity_change", "pulse_half_width"
UNDAMPED = "damping_ratio == 0"
# Pulses that meet another pre-stress, and come back from it or not; and those that began in each.
PERTURBED = ("pulses_across_a_step", "pulses_across_wide_steps", "pulses_perturbed_elsewhere")
UNPERTURBED = ("any_prestress", "steady_displacement", "steady_elsewhere")


def equation(
    evidence: Evidence, id: str, measured: str, predicted: str, runs: Mapping[str, str]
) -> Equation:
    """An equation between columns, by a rule of manuscript/claims.yaml."""
    tables = [evidence.finest(name, where=where) for name, where in runs.items()]
    return evidence.equation(id, pd.concat(tables), measured, predicted)


class Always(NamedTuple):
    """A rule of manuscript/claims.yaml: what must hold in each run of some sweeps."""

    sweeps: Sequence[str]
    where: str = ""
    holds: str = ""
    decidable: str = ""
    ends: Sequence[str] = ()
    counted: Mapping[str, str] = {}
    numbers: Mapping[str, str] = {}


def always(evidence: Evidence, id: str, **keys: Any) -> Qualitative:
    """A claim that has a rule `Always`."""
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


def meet(table: pd.DataFrame) -> dict[str, pd.Series]:
    """Whether pulses change more than one that began alike and meets level 0: by -1, 0 or 1."""
    began = table[table["beyond"] == 0.0].set_index("left")
    change, still = table[CHANGE], table["left"].map(began[CHANGE])
    wider = table[HALF_WIDTH] - table["left"].map(began[HALF_WIDTH])
    signs = {
        "changed": np.sign(change).where(change.abs() > still.abs(), 0.0),
        "widened": np.sign(wider),
    }
    # A pulse that is gone has decayed.
    gone = table["regime"] == "arrested"
    return {name: sign.mask(gone, -1.0).fillna(0.0) for name, sign in signs.items()}


def front_speed_moderate_gamma(evidence: Evidence, id: str) -> Approximate:
    """The front speed without damping for gamma up to 1."""
    where = f"{UNDAMPED} and 0.1 <= gamma <= 1"
    tables = evidence.lattices("speed_against_gamma", "steady_displacement", where=where)
    return evidence.approximate(id, tables, "front_speed_right", "paper_front_speed_right")


def thin_layer(evidence: Evidence, id: str) -> Qualitative:
    """The thickness, which is 1, over the width of each steady pulse is below the tolerance."""
    table = evidence.finest("any_prestress")
    width, slowest = table["pulse_width"], table["front_speed_right"].min()
    further = {"narrowest pulse, in H": width.min(), "widest pulse": width.max()}
    further["slowest front, over the fastest wave"] = slowest
    allowed = evidence.tolerance(id)
    thin = 1.0 / width <= allowed
    told: dict = {name: sorted({*table[name]}) for name in ("gamma", "damping_ratio")}
    told["largest"] = (np.pi * allowed) ** 2
    return Qualitative(decided=thin, failing=rules.UNMET, further=further, told=told)


def within(
    deviation: np.ndarray, uncertainty: np.ndarray, allowed: float, sure: bool = False
) -> bool | None:
    """Whether all deviations are allowed, if ``sure`` with their uncertainties; None where open."""
    if np.any(deviation - uncertainty > allowed):
        return False
    return True if np.all(deviation + sure * uncertainty <= allowed) else None


def pairs(table: pd.DataFrame, sizes: list[str]) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Relative differences of sizes between each two runs, with their uncertainties."""
    values = table[sizes].to_numpy()
    uncertainties = table[[f"uncertainty_{size}" for size in sizes]].to_numpy()
    for first, second in combinations(range(len(table)), 2):
        uncertainty = uncertainties[first] + uncertainties[second]
        deviation = np.abs(values[first] / values[second] - 1.0)
        yield deviation, uncertainty / np.abs(values[second])


def displacement_pulse_unique(evidence: Evidence, id: str) -> Qualitative:
    """Pulses of one pre-stress from different beginnings are the same pulse."""
    table = evidence.finest("nucleation_widths", "any_prestress", "steady_elsewhere", *PERTURBED)
    sizes, allowed = ["pulse_peak_velocity", "pulse_width", "pulse_slip"], evidence.tolerance(id)
    decided: list[bool | None] = []
    for _, rows in table.groupby(["beyond", "gamma", "damping_ratio"]):
        decided += [within(*pair, allowed) for pair in pairs(rows, sizes)]
    return Qualitative(decided=decided)


def perturbed_pulses_settle(evidence: Evidence, id: str) -> Qualitative:
    """A pulse sent into another pre-stress leaves the slip of the steady pulse there."""
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
    return Qualitative(decided=agreeing(*settled), further=further)


def zero_net_stress_change(evidence: Evidence, id: str) -> Equation:
    """No strain is left behind a pulse that keeps its shape; where some is, the pulse changes."""
    strain = evidence.finest("regimes_beyond", where="beyond != 0")["strain_left"].to_numpy()
    changes = evidence.agreed("regimes_beyond", "beyond != 0", "changed != 0")

    def straining(tolerance: float) -> Qualitative:
        return Qualitative(decided=np.array(changes, object)[strain > tolerance])

    table = evidence.finest("stress_pulses", where=UNDAMPED)
    claim = evidence.equation(id, table, "strain_left", "0")
    counts = straining(claim.tolerance).counts()
    return replace(claim, counts=counts, besides=lambda allowed: straining(allowed).verdict())


def stress_pulse_not_unique(evidence: Evidence, id: str) -> Qualitative:
    """Different pre-stress makes different pulses in the same region of zero pre-stress."""
    table = evidence.finest("stress_pulses", where="damping_ratio > 0")
    # The smallest damping is that of the figures; without any, the lattice rings.
    table = table[table["damping_ratio"] == table["damping_ratio"].min()]
    allowed, decided = evidence.tolerance(id), []
    for deviation, uncertainty in pairs(table, ["pulse_peak_velocity", HALF_WIDTH]):
        alike = within(deviation, uncertainty, allowed, sure=True)
        decided.append(None if alike is None else not alike)
    return Qualitative(decided=decided)


def stress_pulse_set_by_prestress(evidence: Evidence, id: str) -> Qualitative:
    """Peak and half-width on damped lattices are the exact solution's functionals of pre-stress."""
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
