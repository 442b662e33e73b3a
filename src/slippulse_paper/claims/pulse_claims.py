"""Judge claims about pulses on lattices: equations, uniqueness and stability.

`equation` and `always` evaluate the rules of manuscript/claims.yaml. The other functions take the
evidence and the id of their claim, and return the result.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from . import rules
from .evidence import Evidence, agreed_answers, value_of
from .kinds import Approximate, Equation, Qualitative

# Regime of a rupture with a pulse on both sides.
TWO_WAY = "pulses, two-way"
# Columns of the measured table.
VELOCITY_CHANGE = "largest_velocity_change"
HALF_WIDTH = "pulse_half_width"
# Conditions that select runs.
WITHOUT_DAMPING = "damping_ratio == 0"
WITH_DAMPING = "damping_ratio > 0"
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
    """A rule of manuscript/claims.yaml: a condition that must hold in each run of some sweeps.

    All conditions are expressions over columns.

    sweeps : names of the sweeps
    where : selects runs; all of them if it is empty
    holds : the condition; if it is empty, the regime must be one of ``ends``
    decidable, ends : see `Evidence.agreed`
    counted : conditions by words; the regimes of the selected runs are counted in the table of
        claims
    numbers : expressions by words, for the table of claims
    """

    sweeps: Sequence[str]
    where: str = ""
    holds: str = ""
    decidable: str = ""
    ends: Sequence[str] = ()
    counted: Mapping[str, str] = {}
    numbers: Mapping[str, str] = {}


def always(evidence: Evidence, id: str, **keys: Any) -> Qualitative:
    """Judge a claim that has a rule `Always`, whose fields are the keyword arguments."""
    rule = Always(**keys)
    # The condition may contain the tolerance of the claim and that of steady pulses.
    holds = rule.holds.format(tolerance=evidence.tolerance(id), steady=evidence.steady)
    if not holds:
        holds = f"regime in {rule.ends}"
    decided: list[bool | None] = []
    for sweep in rule.sweeps:
        decided += evidence.agreed(sweep, rule.where, holds, rule.decidable, rule.ends)
    # Additional numbers for the table of claims: expressions, and counts of regimes.
    table = evidence.tables[rule.sweeps[0]]
    further = {words: float(value_of(table, number)) for words, number in rule.numbers.items()}
    for words, condition in rule.counted.items():
        regimes = evidence.finest(*rule.sweeps, where=condition)["regime"].value_counts()
        further |= {f"{words}: {regime}": float(count) for regime, count in regimes.items()}
    return Qualitative(decided=decided, further=further)


def change_signs(table: pd.DataFrame) -> dict[str, pd.Series]:
    """Return the signs of the changes of velocity and half-width: 1, -1, or 0 for no change.

    The columns are "changed" and "widened". Each pulse enters the level ``beyond``. It is compared
    with the pulse that began in the same pre-stress and enters the level 0, where theory says that
    it does not change. What this one changes on a lattice does not count as a change.
    """
    staying = table[table["beyond"] == 0.0].set_index("left")
    change = table[VELOCITY_CHANGE]
    change_of_staying = table["left"].map(staying[VELOCITY_CHANGE])
    has_changed = change.abs() > change_of_staying.abs()
    widening = table[HALF_WIDTH] - table["left"].map(staying[HALF_WIDTH])
    signs = {
        "changed": np.sign(change).where(has_changed, 0.0),
        "widened": np.sign(widening),
    }
    # A pulse that has died out counts as decayed.
    has_died = table["regime"] == "arrested"
    return {name: sign.mask(has_died, -1.0).fillna(0.0) for name, sign in signs.items()}


def front_speed_moderate_gamma(evidence: Evidence, id: str) -> Approximate:
    """Compare the front speed without damping for gamma up to 1 with the formula."""
    where = f"{WITHOUT_DAMPING} and 0.1 <= gamma <= 1"
    tables = evidence.lattices("speed_against_gamma", "steady_displacement", where=where)
    return evidence.approximate(id, tables, "front_speed_right", "paper_front_speed_right")


def thin_layer(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether the thickness, which is 1, is much smaller than each steady pulse width."""
    table = evidence.finest("any_prestress")
    allowed = evidence.tolerance(id)
    width = table["pulse_width"]
    is_thin = 1.0 / width <= allowed
    further = {
        "narrowest pulse, in H": width.min(),
        "widest pulse": width.max(),
        "slowest front, over the fastest wave": table["front_speed_right"].min(),
    }
    template_values = {
        "gamma": sorted({*table["gamma"]}),
        "damping_ratio": sorted({*table["damping_ratio"]}),
        # By the paper's formula a pulse is wide enough if gamma (1 - tau_0^2)/tau_0^2 is at most
        # this.
        "largest": (np.pi * allowed) ** 2,
    }
    return Qualitative(
        decided=is_thin, failing=rules.UNMET, further=further, template_values=template_values
    )


def within(
    deviation: np.ndarray, uncertainty: np.ndarray, allowed: float, sure: bool = False
) -> bool | None:
    """Return whether all deviations are at most ``allowed``; None if that is open.

    It is False if a deviation minus its uncertainty is larger. Otherwise it is True if all
    deviations are at most ``allowed``: with their uncertainties added if ``sure``, else as they
    are.
    """
    if np.any(deviation - uncertainty > allowed):
        return False
    largest = deviation + uncertainty if sure else deviation
    return True if np.all(largest <= allowed) else None


def differences_of_pairs(
    table: pd.DataFrame, sizes: list[str]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield relative differences between the pulses of each pair of runs, and uncertainties.

    Both arrays have one value for each of the columns ``sizes``.
    """
    values = table[sizes].to_numpy()
    uncertainties = table[[f"uncertainty_{size}" for size in sizes]].to_numpy()
    for first, second in combinations(range(len(table)), 2):
        difference = np.abs(values[first] / values[second] - 1.0)
        uncertainty = uncertainties[first] + uncertainties[second]
        yield difference, uncertainty / np.abs(values[second])


def displacement_pulse_unique(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether pulses in the same pre-stress that began differently are the same pulse."""
    table = evidence.finest("nucleation_widths", "any_prestress", "steady_elsewhere", *PERTURBED)
    sizes = ["pulse_peak_velocity", "pulse_width", "pulse_slip"]
    allowed = evidence.tolerance(id)
    decided: list[bool | None] = []
    # "beyond" is the level in which a pulse ends, and in which it is measured.
    for _, same_prestress in table.groupby(["beyond", "gamma", "damping_ratio"]):
        for difference, uncertainty in differences_of_pairs(same_prestress, sizes):
            decided.append(within(difference, uncertainty, allowed))
    return Qualitative(decided=decided)


def perturbed_pulses_settle(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether a pulse that enters another pre-stress leaves the slip of its steady pulse."""
    # Slips of a steady pulse: simulated, exact, and by the paper's formula without damping.
    slip_columns = {
        "slip off by at most": "pulse_slip",
        "slip off the exact slip by at most": "exact_pulse_slip",
        "slip off that without damping by at most": "paper_pulse_slip",
    }
    # For each lattice, the deviations of the perturbed pulses from these slips.
    deviations = []
    perturbed, unperturbed = evidence.lattices(*PERTURBED), evidence.lattices(*UNPERTURBED)
    for pulses, steady_pulses in zip(perturbed, unperturbed, strict=True):
        steady = matching_steady_pulses(pulses, steady_pulses)[[*slip_columns.values()]]
        deviations.append((pulses[["pulse_slip"]].to_numpy() / steady - 1.0).abs())
    finest, middle, _ = (table["pulse_slip"] <= evidence.tolerance(id) for table in deviations)
    largest = deviations[0].max().fillna(0.0)
    further = {words: float(largest[column]) for words, column in slip_columns.items()}
    return Qualitative(decided=agreed_answers(finest, middle), further=further)


def matching_steady_pulses(pulses: pd.DataFrame, steady_pulses: pd.DataFrame) -> pd.DataFrame:
    """Return, for each pulse, the run whose uniform pre-stress is the level that the pulse enters.

    A row is NaN if there is no such run.
    """
    keys = ["left", "gamma", "damping_ratio"]
    by_level = steady_pulses.drop_duplicates(keys).set_index(keys)
    entered = pulses[["beyond", "gamma", "damping_ratio"]]
    return by_level.reindex(pd.MultiIndex.from_frame(entered))


def zero_net_stress_change(evidence: Evidence, id: str) -> Equation:
    """Judge whether a pulse that keeps its shape leaves no strain, and others grow or decay."""
    enters_stress = "beyond != 0"
    strain = evidence.finest("regimes_beyond", where=enters_stress)["strain_left"].to_numpy()
    changes = evidence.agreed("regimes_beyond", enters_stress, "changed != 0")

    def changing_if_strained(tolerance: float) -> Qualitative:
        """Judge whether all pulses that leave a strain above the tolerance grow or decay."""
        return Qualitative(decided=np.array(changes, object)[strain > tolerance])

    # In zero pre-stress pulses keep their shape.
    unchanging = evidence.finest("stress_pulses", where=WITHOUT_DAMPING)
    claim = evidence.equation(id, unchanging, "strain_left", "0")
    return replace(
        claim,
        counts=changing_if_strained(claim.tolerance).counts(),
        extra_verdict=lambda tolerance: changing_if_strained(tolerance).verdict(),
    )


def stress_pulse_not_unique(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether different pre-stress makes different pulses in a region of zero pre-stress.

    Each pair of runs must have different pulses, in peak velocity or in half-width.
    """
    table = evidence.finest("stress_pulses", where=WITH_DAMPING)
    # The smallest nonzero damping ratio is that of the figures; without damping the lattice rings.
    table = table[table["damping_ratio"] == table["damping_ratio"].min()]
    allowed = evidence.tolerance(id)
    decided: list[bool | None] = []
    for difference, uncertainty in differences_of_pairs(table, ["pulse_peak_velocity", HALF_WIDTH]):
        is_same_pulse = within(difference, uncertainty, allowed, sure=True)
        decided.append(None if is_same_pulse is None else not is_same_pulse)
    return Qualitative(decided=decided)


def stress_pulse_set_by_prestress(evidence: Evidence, id: str) -> Qualitative:
    """Compare peak and half-width on damped lattices with the exact solution."""
    table = evidence.finest("stress_pulses", where=WITH_DAMPING)
    allowed = evidence.tolerance(id)
    sizes = ["pulse_peak_velocity", HALF_WIDTH]
    exact = table[["exact_largest_velocity", "exact_half_width"]].to_numpy()
    deviation = (table[sizes] / exact - 1.0).abs()
    uncertainty = table[[f"uncertainty_{size}" for size in sizes]].to_numpy() / exact
    decided = []
    for deviation_of_run, uncertainty_of_run in zip(deviation.to_numpy(), uncertainty, strict=True):
        decided.append(within(deviation_of_run, uncertainty_of_run, allowed))
    peak, half_width = deviation.max()
    words = "on the lattice, with damping, off by at most"
    further = {f"peak {words}": float(peak), f"half-width {words}": float(half_width)}
    return Qualitative(decided=decided, further=further)
