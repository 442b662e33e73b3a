"""Judge claims about the transition from crack to pulse, and about the arrest of a front.

Most claims are judged at each combination of choices that the paper leaves open. `transitions`
returns the runs of all combinations for a displacement boundary, and `arrests` for a stress
boundary. The tables of all of them have the same columns:

time, length : time and length of the transition, or of the arrest
estimated_time, estimated_length : the paper's estimates
covered : distance that the left front has covered (arrests only)

A function that judges a claim takes the evidence and the id of the claim, and returns the result.
The `further` numbers of the result are shown in the table of claims, and sentences quote its
`template_values`.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from typing import NamedTuple

import numpy as np
import pandas as pd

from slippulse.measurement.front_paths import fit_line

from . import rules
from .choices import (
    LAST_RELEASE_FRACTION,
    Chosen,
    Combination,
    OverChoices,
    over_choices,
    text_of_value,
)
from .evidence import Evidence, agreed_answers, fit_exponent, ratios, with_grid_uncertainty
from .kinds import NAN, Approximate, Claim, Equation, Qualitative
from .rules import Spread
from .space_time_claims import readings_by_name

# Condition under which blocks do not slide back. The threshold that the paper prints also applies
# backwards, so a pre-stress of -1 or less would make blocks slide back at once.
NO_BACKWARD_SLIP = "left > -1"
# Condition under which a front has stopped. Otherwise the run ends while blocks are still released.
HAS_STOPPED = "end_time > 1.1 * last_release_time"
# A front counts as arrested at x_minus if its distance from x_minus is at most this. The unit is
# the thickness H of the layer, which is the smallest length of the model.
MAX_ARREST_GAP = 1.0
# The numbers that are shown with a claim are for this fraction of the distance to x_minus.
SHOWN_FRACTION = 0.95
# Some claims compare runs that differ only in the level or only in gamma. These parameters are then
# the same.
OTHER_PARAMETERS = ("width", "damping_ratio", "release")
# Quantities of the transition, with their symbols.
SYMBOLS = {"time": "T", "length": "L"}
# The paper's T_trans under a displacement boundary can be understood in two ways (criteria): as the
# time of the first stick, or as the time at which the slip reaches the printed value 2 tau/gamma,
# where tau is taken as the level tau_0.
FIRST_STICK, PRINTED_SLIP = "first stick", r"slip $2\tau_0/\gamma$"
# New names of columns, by their names in the tables of results. A transition is measured at the
# first stick if the displacement is held, and at a fraction of the path if the stress is held.
PAPER_ESTIMATES = {
    "paper_transition_time": "estimated_time",
    "paper_transition_length": "estimated_length",
}
TRANSITION_COLUMNS = {
    "transition_time": "time",
    "transition_length": "length",
    **PAPER_ESTIMATES,
}
COLUMNS_BY_CRITERION = {
    FIRST_STICK: TRANSITION_COLUMNS,
    PRINTED_SLIP: {
        "slip_time_background": "time",
        "slip_length_background": "length",
        **PAPER_ESTIMATES,
    },
}
# New names of columns of lattices under held stress, which are measured at the last release.
ARREST_COLUMNS = {
    "last_release_distance": "covered",
    "last_release_time": "time",
    "last_release_length": "length",
}


class Runs(NamedTuple):
    """Runs at one combination of choices.

    choice : values of the choices, by name
    tables : one table for each lattice, the finest first, or a single table of exact solutions
    """

    choice: Chosen
    tables: list[pd.DataFrame]


def lattice_runs(tables: list[pd.DataFrame]) -> list[Runs]:
    """Return simulated runs, divided by release rule and damping ratio; empty if there are none.

    tables : one table for each lattice, the finest first, with the same runs in the same order
    """
    finest = tables[0]
    choices = finest[["release", "damping_ratio"]].drop_duplicates()
    runs = []
    for release, damping_ratio in choices.itertuples(index=False):
        has_choices = (finest["release"] == release) & (finest["damping_ratio"] == damping_ratio)
        choice: Chosen = {"release": release, "damping_ratio": damping_ratio, "solution": "lattice"}
        runs.append(Runs(choice, [table[has_choices.to_numpy()] for table in tables]))
    return runs


def simulated_runs(evidence: Evidence, boundary: str) -> list[Runs]:
    """Return the lattice runs of figure 5, and the undamped ones of figures 10 and 11.

    So a claim is judged at the damping ratio of figure 5, and without damping. A sweep is left out
    if a changed configuration has no such runs in it.
    """
    # The sweeps of these figures, with conditions that select runs. Runs with a pre-stress at which
    # blocks would slide back are left out.
    conditions = {
        f"scaling_{boundary}": NO_BACKWARD_SLIP,
        f"damping_{boundary}": f"{NO_BACKWARD_SLIP} and damping_ratio == 0",
    }
    simulated = []
    for sweep, condition in conditions.items():
        simulated += lattice_runs(evidence.lattices(sweep, where=condition))
    return simulated


def exact_runs(evidence: Evidence, boundary: str) -> list[Runs]:
    """Return exact solutions at each combination of the choices that the paper leaves open.

    The choices with which we drew figure 5 come first, because claims show the numbers of the first
    combination. Under a stress boundary there are two more choices: the shape of the nucleation,
    "Gaussian" or "tent", and the fraction of its path at which the left front counts as arrested.
    """
    # The names of the open choices, and their values in the first run of figure 5.
    open_choices = ["release", "damping_ratio"]
    first_run = evidence.tables[f"scaling_{boundary}"].iloc[0]
    choices_of_figure: Chosen = {name: first_run[name] for name in open_choices}
    if boundary == "stress":
        # The fraction is not a choice of figure 5. The numbers that claims show are for
        # SHOWN_FRACTION.
        open_choices += ["nucleation", "fraction"]
        choices_of_figure["fraction"] = SHOWN_FRACTION
    table = evidence.tables["open_choices"].query(f"boundary == {boundary!r}")
    exact = []
    for values, rows in table.groupby(open_choices):
        choice: Chosen = dict(zip(open_choices, values, strict=True))
        # Runs with a pre-stress at which blocks would slide back are left out. In a changed
        # configuration, no run may be left. Claims are then not testable.
        rows = rows.query(NO_BACKWARD_SLIP)
        exact.append(Runs(choice | {"solution": "exact"}, [rows]))
    # False comes before True, so the choices of figure 5 come first. Otherwise `sorted` keeps the
    # order of `groupby`, which is alphabetical. So the Gaussian nucleation of figure 5 comes before
    # the tent, and claims show its numbers.
    return sorted(exact, key=lambda runs: not choices_of_figure.items() <= runs.choice.items())


@cache
def transitions(evidence: Evidence) -> list[Runs]:
    """Return runs under a displacement boundary, for both ends of the transition (criteria).

    The transition ends at the first stick, or when the slip at x = 0 reaches the value that the
    paper prints (PRINTED_SLIP). Exact solutions are measured at the first stick only.
    """
    lattices = simulated_runs(evidence, "displacement")
    exact = exact_runs(evidence, "displacement")
    runs_by_criterion = {FIRST_STICK: lattices + exact, PRINTED_SLIP: lattices}
    transition_runs = []
    for criterion, runs_of_criterion in runs_by_criterion.items():
        # The columns of this criterion become the columns time and length.
        new_names = COLUMNS_BY_CRITERION[criterion]
        for choice, tables in runs_of_criterion:
            renamed = [table.rename(columns=new_names) for table in tables]
            transition_runs.append(Runs(choice | {"criterion": criterion}, renamed))
    return transition_runs


@cache
def arrests(evidence: Evidence) -> list[Runs]:
    """Return runs under a stress boundary, measured when the left front counts as arrested.

    In an exact solution the front counts as arrested when it has covered a fraction of |x_minus|,
    and on a lattice at its last release. One run is enough for each level, as
    `widest_at_each_level` explains.
    """
    arrest_runs = []
    for choice, tables in exact_runs(evidence, "stress"):
        widest = [widest_at_each_level(table, TRANSITION_COLUMNS) for table in tables]
        arrest_runs.append(Runs(choice, widest))
    # The choices of exact solutions include the nucleation and the fraction. The choices of
    # lattices do not, and so these two are added.
    at_last_release: Chosen = {"nucleation": "Gaussian", "fraction": LAST_RELEASE_FRACTION}
    for choice, tables in simulated_runs(evidence, "stress"):
        widest = [widest_at_each_level(table, ARREST_COLUMNS) for table in tables]
        arrest_runs.append(Runs(choice | at_last_release, widest))
    return arrest_runs


def widest_at_each_level(table: pd.DataFrame, new_names: Mapping[str, str]) -> pd.DataFrame:
    """Return the run with the widest nucleation at each level, with the paper's estimates added.

    The paper estimates the time that the left front needs for the distance that it has covered, and
    the distance between the fronts at this time. The paper assumes that both run at speed 1.

    new_names : new names of the columns, by their names in the table
    """
    # The width of the nucleation is the only length. So the ratios of measured and estimated
    # numbers are equal in all runs of a level, and one of the runs is enough. On a lattice the
    # widest nucleation contains the most blocks.
    widest = table.sort_values("width").drop_duplicates("left", keep="last")
    widest = widest.rename(columns=new_names)
    if "covered" not in widest:
        # An exact solution is measured when the front has covered a fraction of |x_minus|. At the
        # speed 1 the estimated time in its table is equal to |x_minus|.
        widest = widest.assign(covered=widest["fraction"] * widest["estimated_time"])
    # The new estimates are for the covered distance. At speed 1 the left front needs a time equal
    # to this distance. Since the right front has run equally far, the fronts are twice as far
    # apart.
    covered = widest["covered"]
    return widest.assign(estimated_time=covered, estimated_length=2.0 * covered)


def median_ratio_by_fraction(combinations: Sequence[Combination]) -> dict[float | str, float]:
    """Return the median ratio of measured and estimated numbers, by the fraction of the path.

    At this fraction the left front counts as arrested. Runs that are measured at the last release
    have the text LAST_RELEASE_FRACTION instead of a fraction. The median is NaN if no run has a
    number. All other choices are those of the first combination.
    """
    first = combinations[0].choice
    fixed_names = ("release", "damping_ratio", "nucleation")
    by_fraction: dict[float | str, float] = {}
    for combination in combinations:
        choice = combination.choice
        if all(choice.get(name) == first[name] for name in fixed_names):
            # The entry "measured" of an estimate is its median ratio.
            by_fraction[choice["fraction"]] = combination.claim.fields().get("measured", NAN)
    return by_fraction


def described_median_ratios(combinations: Sequence[Combination]) -> dict[str, float]:
    """Return the result of `median_ratio_by_fraction`, with a label as the key of each ratio.

    The paper leaves open at which point of its path the left front counts as arrested: after a
    fraction of the path, or at the last release. The claim is judged with each of these ends, and
    has one median ratio of the measured and the estimated number for each. The labels, such as
    "measured / estimated value (median), end at last release", are shown in the table of claims,
    in alphabetical order.
    """
    by_label = {}
    for fraction, median in median_ratio_by_fraction(combinations).items():
        # The fraction is a number, or the text LAST_RELEASE_FRACTION, which is already in words.
        end = fraction if isinstance(fraction, str) else f"{text_of_value(fraction)} of the path"
        by_label[f"measured / estimated value (median), end at {end}"] = median
    return dict(sorted(by_label.items()))


def judge_each(
    runs: Iterable[Runs], judge: Callable[[list[pd.DataFrame]], Claim]
) -> list[Combination]:
    """Judge a claim at each combination.

    judge : function that judges the claim from the tables of one combination
    """
    return [Combination(choice, judge(tables)) for choice, tables in runs]


class JudgedEstimate(NamedTuple):
    """The results about an estimate of the paper.

    combinations : the result at each combination of choices
    from_exact : deviations of our lattices from exact theory
    arrow_ratio : length of the arrow in figure 4 divided by the estimate, and its reading error;
        empty if there is no arrow
    """

    combinations: list[Combination]
    from_exact: Spread
    arrow_ratio: dict[str, float]


def judge_estimate(evidence: Evidence, id: str, boundary: str, quantity: str) -> JudgedEstimate:
    """Judge the paper's estimate of a quantity ("time" or "length") at each combination.

    Also return how much lattice runs deviate from exact theory, and the ratio of the arrow in
    figure 4 to the estimate.
    """

    def judge(tables: list[pd.DataFrame]) -> Approximate:
        """Compare the quantity with its estimate, in the runs of one combination."""
        return evidence.approximate(id, tables, quantity, f"estimated_{quantity}")

    runs = transitions(evidence) if boundary == "displacement" else arrests(evidence)
    return JudgedEstimate(
        combinations=judge_each(runs, judge),
        from_exact=evidence.deviation_from_exact(f"scaling_{boundary}", f"transition_{quantity}"),
        arrow_ratio=arrow_of_figure_4(evidence, boundary, quantity),
    )


def arrow_of_figure_4(evidence: Evidence, boundary: str, quantity: str) -> dict[str, float]:
    """Return the length of an arrow in figure 4 divided by the estimate, and its reading error.

    The figure has a panel for each boundary. Arrows show the time or length of the transition. The
    result is empty if this one has no arrow.
    """
    name = f"arrow_{quantity}_stress" if boundary == "stress" else f"arrow_{quantity}"
    reading = evidence.readings.get(name)
    if reading is None:
        return {}
    scene = evidence.tables[f"space_time_{boundary}"].iloc[0]
    estimate = float(scene[f"paper_transition_{quantity}"])
    return {
        "arrow of figure 4 divided by the estimate": reading["value"] / estimate,
        "reading error of the ratio of arrow to estimate": reading["reading_error"] / estimate,
    }


def displacement_transition(evidence: Evidence, id: str, quantity: str) -> OverChoices:
    """Judge the paper's estimate of the transition under a displacement boundary, by both criteria.

    The transition is at the first stick, or when the slip at x = 0 reaches 2 tau/gamma, the value
    that the paper prints. Not all runs reach this slip, so the claim also shows how many do. It
    shows, too, how much our lattices deviate from exact theory (from_exact), and the length of the
    arrow in figure 4 divided by the estimate (arrow_ratio).

    quantity : "time" or "length"
    """
    judged = judge_estimate(evidence, id, "displacement", quantity)
    # The printed slip with tau = tau_0, the level of the pre-stress.
    runs = evidence.finest("scaling_displacement")
    at_printed_slip = runs.rename(columns=COLUMNS_BY_CRITERION[PRINTED_SLIP])
    # The ratio is NaN if a run does not reach this slip.
    ratio = ratios(at_printed_slip, quantity, f"estimated_{quantity}")
    is_within_tolerance = (ratio - 1.0).abs() <= evidence.tolerance(id)
    further = {
        f"runs that reach the {PRINTED_SLIP}": float(ratio.count()),
        "all runs": float(len(ratio)),
        f"runs that reach the {PRINTED_SLIP} within the tolerance": float(
            is_within_tolerance.sum()
        ),
    }
    template_values = readings_by_name(evidence) | deviations_at_first_stick(judged.combinations)
    template_values |= {
        "of_runs": len(ratio),
        # Runs that reach the printed slip with tau = tau_0.
        "reach": ratio.count(),
        # Runs that reach it with tau = 1. This is the pre-stress at x = 0, the point whose slip the
        # paper uses to define T_trans, so it is what the paper literally says.
        "reach_literally": runs["slip_time_nucleation"].count(),
    }
    return over_choices(
        judged.combinations,
        from_exact=judged.from_exact,
        further=further | judged.arrow_ratio,
        template_values=template_values,
    )


def deviations_at_first_stick(combinations: Iterable[Combination]) -> dict[str, list[float]]:
    """Return the deviations of the combinations with the criterion first stick, in three groups.

    The groups are:

    undamped : all combinations without damping
    elastic, total : combinations with damping, by release rule
    """
    deviations: dict[str, list[float]] = {"undamped": [], "elastic": [], "total": []}
    for combination in combinations:
        choice, deviation = combination.choice, combination.result["deviation"]
        if choice["criterion"] == FIRST_STICK and deviation is not None:
            is_undamped = choice["damping_ratio"] == 0.0
            group = "undamped" if is_undamped else str(choice["release"])
            deviations[group].append(deviation)
    return deviations


def stress_transition(evidence: Evidence, id: str, quantity: str) -> OverChoices:
    """Judge the paper's estimate of the arrest of the left front, under a stress boundary.

    The estimate is judged for each fraction of the path at which the front may count as arrested,
    and at the last release. The claim also shows the median ratio of measured and estimated numbers
    for each of these, and the length of the arrow in figure 4 divided by the estimate.

    quantity : "time" or "length"
    """
    combinations, from_exact, arrow_ratio = judge_estimate(evidence, id, "stress", quantity)
    further = arrow_ratio | described_median_ratios(combinations)
    return over_choices(combinations, from_exact=from_exact, further=further)


def scaling(evidence: Evidence, id: str, boundary: str) -> OverChoices:
    """Judge whether time T and length L of the transition are proportional to their estimates.

    T and L of the runs are fitted as powers of their estimates, and the exponents should be 1. The
    exponent that is farther from 1 decides. Its uncertainty includes the largest change if all runs
    with one value of one of the varied columns are left out.
    """
    if boundary == "displacement":
        runs, varied_columns = transitions(evidence), ["left", "gamma"]
    else:
        # Without leaf springs gamma has no influence.
        runs, varied_columns = arrests(evidence), ["left"]

    def judge(tables: list[pd.DataFrame]) -> Equation:
        """Fit T and L as powers of their estimates, and judge the exponent farther from 1."""
        exponents = {}
        for quantity, symbol in SYMBOLS.items():
            exponents[symbol] = fit_exponent(
                tables,
                measured=quantity,
                predicted=f"estimated_{quantity}",
                varied_columns=varied_columns,
            )
        farthest = max(exponents, key=lambda symbol: abs(exponents[symbol].value - 1.0))
        measured, uncertainty = exponents[farthest]
        return Equation(
            tolerance=evidence.tolerance(id),
            predicted=np.ones(1),
            measured=np.array([measured]),
            uncertainty=np.array([uncertainty]),
            counts={"runs": len(tables[0])},
            template_values={"symbol": farthest},
        )

    return over_choices(judge_each(runs, judge))


def stress_front_speeds_near_one(evidence: Evidence, id: str) -> OverChoices:
    """Judge whether the mean speeds of both fronts until the arrest are 1, the wave speed.

    The front whose median deviation is larger decides. Its median speed is shown for each fraction
    of the path at which the left front may count as arrested, and for the last release.
    """

    def judge(tables: list[pd.DataFrame]) -> Approximate:
        """Compare the mean speeds of both fronts with 1, and return the worse result."""
        left = evidence.approximate(id, tables, measured="covered / time", predicted="1")
        # The length is the distance between the fronts, and the left front has covered a part of
        # it. The right front has covered the rest.
        right_speed = "(length - covered) / time"
        right = evidence.approximate(id, tables, measured=right_speed, predicted="1")
        if right.median.value > left.median.value:
            return replace(right, template_values={"side": "right"})
        return replace(left, template_values={"side": "left"})

    combinations = judge_each(arrests(evidence), judge)
    return over_choices(combinations, further=described_median_ratios(combinations))


def transition_time_underestimated(evidence: Evidence, id: str) -> OverChoices:
    """Judge whether the left front takes longer to its arrest than it would take at speed 1.

    The paper estimates the time by this speed, and says that the estimate is too short. The
    tolerance of this claim is 0, and the additional time is not limited. An earlier tolerance, at
    which the ledger also shows the verdict, limited the additional time.
    """

    def judge(tables: list[pd.DataFrame]) -> Qualitative:
        """Judge the runs of one combination. A tolerance above 0 limits the additional time."""

        def verdict_with_limit(tolerance: float) -> str:
            limit = tolerance if tolerance > 0.0 else np.inf
            return takes_longer(tables, limit).verdict()

        return replace(takes_longer(tables), extra_verdict=verdict_with_limit)

    runs = arrests(evidence)
    exact = pd.concat([tables[0] for choice, tables in runs if choice["solution"] == "exact"])
    # At the wave speed 1 the time is equal to the covered distance.
    ratio = exact["time"] / exact["covered"]
    words = "smallest exact transition time divided by the time of a front at the wave speed"
    return over_choices(judge_each(runs, judge), further={words: float(ratio.min())})


def takes_longer(tables: list[pd.DataFrame], limit: float = np.inf) -> Qualitative:
    """Judge in each run whether the left front takes longer to its arrest than at speed 1.

    A run is undecided if its two finest lattices disagree, or if the front has not moved.

    tables : one table for each lattice, the finest first, or a single table of exact solutions
    limit : largest allowed additional time, as a fraction of the time at speed 1
    """
    answers = []
    for table in tables[:2]:
        # At speed 1 the time equals the distance. The ratio is NaN if the front has not moved.
        additional_time = table["time"] / table["covered"] - 1.0
        holds = (additional_time > 0.0) & (additional_time <= limit)
        answers.append(holds.astype(object).where(additional_time.notna(), None))
    # A single table of exact solutions is the first and the last one, and agrees with itself.
    return Qualitative(decided=agreed_answers(answers[0], answers[-1]))


def front_arrest_position(evidence: Evidence, id: str) -> OverChoices:
    """Judge the distance of the last release on the left, which should be |x_minus|.

    The claim is judged for each damping ratio and release rule separately. The numbers that are
    shown are those of all runs together.
    """
    sweeps = ("scaling_stress", "damping_stress", "space_time_stress", "arrest_profiles")
    tables = evidence.lattices(*sweeps, where=f"{NO_BACKWARD_SLIP} and {HAS_STOPPED}")
    finest = tables[0]
    runs = []
    # Claims about open choices are judged at these damping ratios.
    for damping_ratio in sorted(evidence.tables["open_choices"]["damping_ratio"].unique()):
        has_ratio = (finest["damping_ratio"] == damping_ratio).to_numpy()
        runs += lattice_runs([table[has_ratio] for table in tables])
    # In a changed configuration, no run may have these ratios. All runs are then judged together.
    runs = runs or [Runs({"solution": "lattice"}, tables)]
    judge = partial(judge_arrest_distance, evidence, id)
    over_all_runs = judge(tables)
    ratio = ratios(finest, "last_release_distance", "balance_distance")
    extremes = {
        "smallest measured / predicted distance": float(ratio.min()),
        "largest measured / predicted distance": float(ratio.max()),
    }
    further = {**over_all_runs.further, **extremes}
    return over_choices(judge_each(runs, judge), shown=over_all_runs, further=further)


def judge_arrest_distance(evidence: Evidence, id: str, tables: list[pd.DataFrame]) -> Approximate:
    """Compare the distance of the last release with |x_minus|.

    There are two additional requirements. The median difference between the two distances (gap)
    must be small. And the distance must be proportional to |x_minus|: if it is fitted as a power of
    |x_minus|, the exponent must be near 1. The template value ``near`` is the verdict on the gap.

    tables : the runs that are judged, in one table for each of three lattices, the finest first
    """
    measured, predicted = "last_release_distance", "balance_distance"
    median_gaps = [(table[predicted] - table[measured]).abs().median() for table in tables]
    gap, gap_uncertainty = with_grid_uncertainty(tables, median_gaps)
    gap_verdict = rules.verdict_on_number(gap, gap_uncertainty, MAX_ARREST_GAP)

    exponent, exponent_uncertainty = fit_exponent(
        tables, measured=measured, predicted=predicted, varied_columns=("left", "width")
    )
    allowed = float(evidence.entries[id]["tolerance_exponent"])
    exponent_verdict = rules.verdict_on_number(abs(exponent - 1.0), exponent_uncertainty, allowed)

    verdict_on_both = rules.worst([gap_verdict, exponent_verdict])
    return replace(
        evidence.approximate(id, tables, measured, predicted),
        # The argument is the tolerance of the claim, which does not limit the gap or the exponent.
        extra_verdict=lambda _tolerance: verdict_on_both,
        further={
            "median gap in H between the last release and x_minus, over all sweeps": gap,
            "fitted exponent of the distance": exponent,
        },
        template_values={"near": gap_verdict, "gap": gap, "gap_uncertainty": gap_uncertainty},
    )


def transition_diverges(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether T_trans and L_trans diverge as gamma approaches 0, at each level.

    The two finest lattices must agree.
    """
    finest, middle, _ = evidence.lattices("scaling_displacement")
    if finest.empty:
        # All runs are flagged, and so the claim is not testable.
        return Qualitative(decided=[])
    on_finest, on_middle = divergence_by_level(finest), divergence_by_level(middle)
    answers = agreed_answers(
        [level.diverges for level in on_finest], [level.diverges for level in on_middle]
    )
    exponents = [(level.time_exponent, level.length_exponent) for level in on_finest]
    mean_of_time, mean_of_length = np.mean(exponents, axis=0)
    further = {
        r"mean exponent of $\gamma$ in $T_\mathrm{trans}$": float(mean_of_time),
        r"mean exponent of $\gamma$ in $L_\mathrm{trans}$": float(mean_of_length),
    }
    return Qualitative(decided=answers, further=further)


class Divergence(NamedTuple):
    """The exponents of gamma in T_trans and L_trans.

    diverges : True if both diverge as gamma approaches 0; None if there are fewer than three runs
    """

    diverges: bool | None
    time_exponent: float
    length_exponent: float


def divergence_by_level(table: pd.DataFrame) -> list[Divergence]:
    """Return the divergence at each level of pre-stress, from the runs at all values of gamma.

    There is one for each width, damping ratio and release rule, if a simulation has several.
    """
    groups = table.sort_values("gamma").groupby(["left", *OTHER_PARAMETERS], dropna=False)
    return [divergence(runs) for _, runs in groups]


def divergence(runs: pd.DataFrame) -> Divergence:
    """Return whether T_trans and L_trans diverge as gamma approaches 0.

    T_trans and L_trans must fall from each value of gamma to the next larger one. At the three
    smallest values, both must be powers of gamma with an exponent that is negative by more than
    three standard errors. The answer is None if there are fewer than three values of gamma.

    runs : runs that differ only in gamma, in ascending order. Runs that end before the transition
        are left out
    """
    quantities = ["transition_time", "transition_length"]
    runs = runs.dropna(subset=quantities)
    if runs.empty:
        return Divergence(None, time_exponent=NAN, length_exponent=NAN)
    changes = runs[quantities].diff()[1:]
    always_fall = (changes < 0.0).all(axis=None)
    logs = np.log(runs[["gamma", *quantities]].head(3))
    # The slopes of these lines are the exponents of gamma.
    time_line = fit_line(logs["gamma"], logs["transition_time"])
    length_line = fit_line(logs["gamma"], logs["transition_length"])
    is_negative = [line.slope + 3.0 * line.slope_error < 0.0 for line in (time_line, length_line)]
    diverges = bool(always_fall and all(is_negative)) if len(runs) >= 3 else None
    return Divergence(diverges, time_exponent=time_line.slope, length_exponent=length_line.slope)


def judge_rise_with_prestress(table: pd.DataFrame, quantity: str) -> Qualitative:
    """Judge whether a quantity rises with the pre-stress, among runs that differ in nothing else.

    Each pair of neighbouring levels counts as one run. A pair is undecided if the change is smaller
    than its uncertainty. Values without an uncertainty are exact.
    """
    uncertainty = table.get(f"uncertainty_{quantity}", 0.0)
    runs = table.assign(uncertainty=uncertainty).sort_values("left").dropna(subset=quantity)
    decided: list[bool | None] = []
    for _, levels in runs.groupby(["gamma", *OTHER_PARAMETERS], dropna=False):
        changes = levels[quantity].diff()[1:]
        # A change has the uncertainties of both its values.
        uncertainties = levels["uncertainty"].rolling(2).sum()[1:]
        for change, uncertainty_of_change in zip(changes, uncertainties, strict=True):
            is_decided = abs(change) > uncertainty_of_change
            decided.append(bool(change > 0.0) if is_decided else None)
    return Qualitative(decided=decided)


def shorter_transition_low_prestress(evidence: Evidence, id: str) -> OverChoices:
    """Judge whether the transition length grows with the pre-stress, on the finest lattice."""

    def judge(tables: list[pd.DataFrame]) -> Qualitative:
        """Judge the runs of one combination."""
        return judge_rise_with_prestress(tables[0], "length")

    return over_choices(judge_each(transitions(evidence), judge))


def pulses_widen_with_prestress(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether the pulse width grows with the pre-stress."""
    return judge_rise_with_prestress(evidence.finest("any_prestress"), "pulse_width")
