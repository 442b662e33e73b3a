"""Judge claims about pulses on lattices: equations, uniqueness and stability.

`equation` and `always` judge claims whose rule is in manuscript/claims.yaml. Each other claim has a
function here, which takes the evidence and the id of the claim, and returns the result. The
`further` numbers of the result are shown in the table of claims, and sentences quote its
`template_values`.
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
# Pulses can be equal only if these columns are.
SAME_PULSE = ("gamma", "damping_ratio", "release", "friction", "scheme")
# Conditions that select runs.
WITHOUT_DAMPING = "damping_ratio == 0"
WITH_DAMPING = "damping_ratio > 0"
# Simulations of pulses that enter another pre-stress, and of pulses in a uniform one.
PERTURBED = ("pulses_across_a_step", "pulses_across_wide_steps", "pulses_perturbed_elsewhere")
UNPERTURBED = ("any_prestress", "steady_displacement", "steady_elsewhere")


def equation(
    evidence: Evidence, id: str, measured: str, predicted: str, runs: Mapping[str, str]
) -> Equation:
    """Judge a claim whose rule says that a measured quantity is equal to a predicted one.

    measured : name of the quantity, which is extrapolated to spacing 0
    predicted : expression over columns
    runs : conditions that select runs, by name of the simulation
    """
    tables = [evidence.finest(name, where=where) for name, where in runs.items()]
    return evidence.equation(id, pd.concat(tables), measured, predicted)


class Always(NamedTuple):
    """A rule of manuscript/claims.yaml: a condition that must hold in each run of some sweeps.

    All conditions are expressions over columns.

    sweeps : names of the sweeps
    where : condition that selects runs; all runs if it is empty
    holds : condition that must hold; if it is empty, the regime must be one of ``ends``
    decidable : condition under which lattices can decide; always if it is empty
    ends : regimes. If lattices cannot decide or disagree, the exact solution must have one of them;
        without ``ends`` the run is then undecided
    counted : conditions that select runs whose regimes are counted, by words for the table of
        claims
    numbers : expressions over the runs of the first sweep, for additional numbers, by words for the
        table of claims
    """

    sweeps: Sequence[str]
    where: str = ""
    holds: str = ""
    decidable: str = ""
    ends: Sequence[str] = ()
    counted: Mapping[str, str] = {}
    numbers: Mapping[str, str] = {}


def always(evidence: Evidence, id: str, **keys: Any) -> Qualitative:
    """Judge a claim whose rule is a condition that must hold in each run of some sweeps.

    In each run the two finest lattices decide. If they disagree or cannot decide, the exact
    solution does (`Evidence.holds_in_runs`).

    keys : fields of the rule (`Always`), such as the sweeps, the condition that must hold (holds),
        the condition under which lattices can decide (decidable), and the regimes of exact
        solutions in which the claim holds (ends)
    """
    rule = Always(**keys)
    # The condition may contain {tolerance}, the tolerance of the claim, and {steady}, the largest
    # relative change of velocity of a steady pulse.
    holds = rule.holds.format(tolerance=evidence.tolerance(id), steady=evidence.steady)
    if not holds:
        # Without a condition, the rupture must end in one of these regimes.
        holds = f"regime in {rule.ends}"
    decided: list[bool | None] = []
    for sweep in rule.sweeps:
        decided += evidence.holds_in_runs(
            sweep, where=rule.where, holds=holds, decidable=rule.decidable, ends=rule.ends
        )
    return Qualitative(decided=decided, further=numbers_of_rule(evidence, rule))


def numbers_of_rule(evidence: Evidence, rule: Always) -> dict[str, float]:
    """Return the additional numbers of a rule, by words for the table of claims.

    The numbers are values of expressions over the runs of the first sweep (field numbers of the
    rule), and the number of runs with each regime among those that meet a condition (field
    counted).
    """
    first_sweep = evidence.tables[rule.sweeps[0]]
    by_words = {}
    for words, expression in rule.numbers.items():
        by_words[words] = float(value_of(first_sweep, expression))
    for words, condition in rule.counted.items():
        regimes = evidence.finest(*rule.sweeps, where=condition)["regime"].value_counts()
        by_words |= {f"{words}: {regime}": float(count) for regime, count in regimes.items()}
    return by_words


def growth_signs(table: pd.DataFrame) -> dict[str, pd.Series]:
    """Return two columns of signs: 1 if a pulse grows, -1 if it decays, 0 if it does neither.

    Each pulse formed at the pre-stress level 0, and then entered the level in the column beyond.
    The pulse is compared with a reference: the pulse of an otherwise equal run that stays at the
    level 0. By theory the reference keeps its size.

    The columns are:

    velocity_growth : sign of the velocity change; 0 if not larger than that of the reference
    width_growth : sign of the half-width minus that of the reference

    Both signs are -1 if the pulse has died, and NaN if they are unknown.
    """
    keys = ["left", "right", "width", "dx", "damping_ratio", "release", "friction"]
    references = table[table["beyond"] == 0.0].drop_duplicates(keys).set_index(keys)
    # The reference of each run, in the order of the runs.
    reference = references.reindex(pd.MultiIndex.from_frame(table[keys])).set_index(table.index)
    change = table[VELOCITY_CHANGE]
    has_changed = change.abs() > reference[VELOCITY_CHANGE].abs()
    widening = table[HALF_WIDTH] - reference[HALF_WIDTH]
    is_known = change.notna() & reference[VELOCITY_CHANGE].notna()
    velocity_growth = np.sign(change).where(has_changed, 0.0).where(is_known)
    width_growth = np.sign(widening)
    has_died = table["regime"] == "arrested"
    return {
        "velocity_growth": velocity_growth.mask(has_died, -1.0),
        "width_growth": width_growth.mask(has_died, -1.0),
    }


def front_speed_moderate_gamma(evidence: Evidence, id: str) -> Approximate:
    """Compare the front speed without damping, for gamma from 0.1 to 1, with the paper's formula.

    The formula is v = 1/sqrt(1 - tau_0^2). Another claim, front_speed, is about the limit of small
    gamma. Here the runs of two simulations are judged together.
    """
    where = f"{WITHOUT_DAMPING} and 0.1 <= gamma <= 1"
    tables = evidence.lattices("speed_against_gamma", "steady_displacement", where=where)
    return evidence.approximate(id, tables, "front_speed_right", "paper_front_speed_right")


def thin_layer(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether the layer is thin: its thickness must be much smaller than each pulse width.

    The thickness, 1, divided by the width must not be larger than the tolerance. A thin layer is a
    premise of the model. If it fails, the verdict is "premise not met".
    """
    table = evidence.finest("any_prestress")
    allowed = evidence.tolerance(id)
    width = table["pulse_width"]
    # A run without a pulse is undecided (None). It has no width.
    is_thin = (1.0 / width <= allowed).astype(object).where(width.notna(), None)
    further = {
        "width of the narrowest pulse, in units of H": width.min(),
        "width of the widest pulse, in units of H": width.max(),
        "slowest front speed divided by the speed of the fastest wave": table[
            "front_speed_right"
        ].min(),
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


def all_within(
    deviations: np.ndarray,
    uncertainties: np.ndarray,
    allowed: float,
    add_uncertainties: bool = False,
) -> bool | None:
    """Return True if all deviations are at most ``allowed``, False if one is larger, None if open.

    A deviation counts as larger only if it is larger even after its uncertainty is subtracted.

    add_uncertainties : if True, a deviation must be at most ``allowed`` even after its uncertainty
        is added
    """
    if np.any(deviations - uncertainties > allowed):
        return False
    largest = deviations + uncertainties if add_uncertainties else deviations
    return True if np.all(largest <= allowed) else None


def differences_of_pairs(
    table: pd.DataFrame, sizes: list[str]
) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Yield the relative differences between the pulses of two runs, and their uncertainties.

    This is done for every pair of runs in the table.

    sizes : columns that are compared; both arrays have one value for each of them
    """
    values = table[sizes].to_numpy()
    uncertainties = table[[f"uncertainty_{size}" for size in sizes]].to_numpy()
    for first, second in combinations(range(len(table)), 2):
        difference = np.abs(values[first] / values[second] - 1.0)
        uncertainty = uncertainties[first] + uncertainties[second]
        yield difference, uncertainty / np.abs(values[second])


def displacement_pulse_unique(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether there is only one pulse for each pre-stress, no matter how it began.

    Each pair of pulses in the same pre-stress must have the same velocity, width and slip, within
    the tolerance. The pulses began at nucleations of different width, or in another pre-stress.
    """
    table = evidence.finest("nucleation_widths", "any_prestress", "steady_elsewhere", *PERTURBED)
    sizes = ["pulse_peak_velocity", "pulse_width", "pulse_slip"]
    allowed = evidence.tolerance(id)
    decided: list[bool | None] = []
    # The column beyond has the level in which a pulse ends, and in which it is measured.
    for _, same_prestress in table.groupby(["beyond", *SAME_PULSE]):
        for differences, uncertainties in differences_of_pairs(same_prestress, sizes):
            decided.append(all_within(differences, uncertainties, allowed))
    return Qualitative(decided=decided)


def perturbed_pulses_settle(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether a pulse that enters another pre-stress becomes a steady pulse there.

    The final slip of the pulse must be that of a simulated steady pulse in this pre-stress, within
    the tolerance and on the two finest lattices. Deviations from two predicted slips are shown,
    too.
    """
    deviations_by_lattice, answers_by_lattice = [], []
    perturbed, unperturbed = evidence.lattices(*PERTURBED), evidence.lattices(*UNPERTURBED)
    # A pulse of a short run is not steady yet. As for all claims, the finest lattice selects runs.
    variation = unperturbed[0]["slip_variation"]
    is_steady = (variation < evidence.tolerance("steady_for_any_prestress")).to_numpy()
    for pulses, steady_pulses in zip(perturbed, unperturbed, strict=True):
        matching = matching_steady_pulses(pulses, steady_pulses[is_steady])
        # The three slips of a steady pulse: simulated, exact, and by the formula without damping.
        steady_slips = matching[["pulse_slip", "exact_pulse_slip", "paper_pulse_slip"]]
        final_slips = pulses[["pulse_slip"]].to_numpy()
        deviations = (final_slips / steady_slips - 1.0).abs()
        is_settled = deviations["pulse_slip"] <= evidence.tolerance(id)
        # The answer stays open if a changed configuration has no steady pulse to compare with, or
        # if its run ends before the first stick, at which a crack turns into a pulse.
        has_become_pulse = pulses["transition_time"].notna().to_numpy()
        is_decided = steady_slips["pulse_slip"].notna() & has_become_pulse
        answers_by_lattice.append(is_settled.astype(object).where(is_decided, None))
        deviations_by_lattice.append(deviations)
    on_finest, on_middle, _ = answers_by_lattice
    largest = deviations_by_lattice[0].max()
    return Qualitative(
        decided=agreed_answers(on_finest, on_middle),
        further={
            "largest deviation of the slip": float(largest["pulse_slip"]),
            "largest deviation of the slip from the exact slip": float(largest["exact_pulse_slip"]),
            "largest deviation of the slip from the formula without damping": float(
                largest["paper_pulse_slip"]
            ),
        },
    )


def matching_steady_pulses(pulses: pd.DataFrame, steady_pulses: pd.DataFrame) -> pd.DataFrame:
    """Return for each pulse the row of a steady pulse in the pre-stress that the pulse enters.

    The row is NaN if there is no such steady pulse.
    """
    # A steady pulse is in uniform pre-stress, whose level is in the column left.
    keys = ["left", *SAME_PULSE]
    # Several simulations may have the same steady pulse.
    by_level = steady_pulses.drop_duplicates(keys).set_index(keys)
    # The column beyond has the level that a pulse enters.
    entered = pulses[["beyond", *SAME_PULSE]]
    return by_level.reindex(pd.MultiIndex.from_frame(entered))


def zero_net_stress_change(evidence: Evidence, id: str) -> Equation:
    """Judge whether a pulse leaves no strain if it keeps its shape, and only then.

    Pulses in zero pre-stress keep their shape, so the strain that they leave behind must be 0. The
    additional requirement is about pulses that enter another pre-stress: all that leave a strain
    behind that is larger than the tolerance must grow or decay.
    """
    # In this simulation pulses enter the pre-stress level in the column beyond. The column
    # velocity_growth is 1 or -1 if they grow or decay there, and otherwise 0.
    enters_stress = "beyond != 0"
    strains = evidence.finest("regimes_beyond", where=enters_stress)["strain_left"].to_numpy()
    has_changed = np.array(
        evidence.holds_in_runs(
            "regimes_beyond",
            where=enters_stress,
            holds="velocity_growth != 0",
            decidable="velocity_growth.notna()",
        ),
        object,
    )

    def changed_if_strained(tolerance: float) -> Qualitative:
        """Judge whether all pulses that leave a strain above the tolerance grow or decay."""
        return Qualitative(decided=has_changed[strains > tolerance])

    in_zero_prestress = evidence.finest("stress_pulses", where=WITHOUT_DAMPING)
    claim = evidence.equation(id, in_zero_prestress, quantity="strain_left", predicted="0")
    return replace(
        claim,
        # The claim shows in how many runs the additional requirement holds or fails.
        counts=changed_if_strained(claim.tolerance).counts(),
        extra_verdict=lambda tolerance: changed_if_strained(tolerance).verdict(),
    )


def stress_pulse_not_unique(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether pulses in zero pre-stress differ if they began in different pre-stress.

    All runs are compared with each other. In each pair, the peak velocities or the half-widths of
    the two pulses must differ by more than the tolerance.
    """
    table = evidence.finest("stress_pulses", where=WITH_DAMPING)
    # Of the runs with damping, take those with the damping ratio of the figures, which is the
    # smallest one. Runs without damping are left out, because their lattices ring.
    table = table[table["damping_ratio"] == table["damping_ratio"].min()]
    allowed = evidence.tolerance(id)
    sizes = ["pulse_peak_velocity", HALF_WIDTH]
    decided: list[bool | None] = []
    for differences, uncertainties in differences_of_pairs(table, sizes):
        # The result is None, undecided, if the uncertainties allow both: that the pulses differ by
        # more than the tolerance, and that they do not.
        is_same_pulse = all_within(differences, uncertainties, allowed, add_uncertainties=True)
        decided.append(None if is_same_pulse is None else not is_same_pulse)
    return Qualitative(decided=decided)


def stress_pulse_set_by_prestress(evidence: Evidence, id: str) -> Qualitative:
    """Compare peak velocity and half-width on damped lattices with the exact solution.

    In each run, both must be within the tolerance.
    """
    table = evidence.finest("stress_pulses", where=WITH_DAMPING)
    allowed = evidence.tolerance(id)
    sizes = ["pulse_peak_velocity", HALF_WIDTH]
    exact = table[["exact_largest_velocity", "exact_half_width"]].to_numpy()
    # Deviations and uncertainties have one row for each run, and one column for each size.
    deviations = (table[sizes] / exact - 1.0).abs()
    uncertainties = table[[f"uncertainty_{size}" for size in sizes]].to_numpy() / exact
    decided = []
    for run, deviations_of_run in enumerate(deviations.to_numpy()):
        decided.append(all_within(deviations_of_run, uncertainties[run], allowed))
    largest = deviations.max()
    words = "largest deviation on damped lattices"
    further = {
        f"{words}, peak": float(largest["pulse_peak_velocity"]),
        f"{words}, half-width": float(largest[HALF_WIDTH]),
    }
    return Qualitative(decided=decided, further=further)
