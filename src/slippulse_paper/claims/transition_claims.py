"""Judge claims about the transition from crack to pulse, and about where a front arrests.

Each claim is judged at every combination of choices that the paper leaves open. `Runs` holds the
tables of one combination: three lattices, or one table of exact solutions. `transitions` collects
them for a held displacement, `arrests` for a held stress; their columns have common names (time,
length, covered, estimated_time, estimated_length).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pandas as pd

from slippulse.measurement.front_paths import fit_line

from . import rules
from .choices import LAST_RELEASE_FRACTION, Chosen, Combination, OverChoices, named, over_choices
from .evidence import Evidence, agreed_answers, exponent, ratios, with_grid_uncertainty
from .kinds import NAN, Approximate, Claim, Equation, Qualitative
from .rules import Uncertain
from .space_time_claims import readings_by_name

# The printed threshold also applies backwards: at or below -1 the pre-stress itself would make
# blocks slide back.
NO_BACKWARD_SLIP = "left > -1"
# A front arrests at x_minus if its distance from there is at most this, in units of H, which is the
# smallest length of the model.
MAX_ARREST_GAP = 1.0
# The fraction of the distance to x_minus whose numbers are shown with a claim.
SHOWN_FRACTION = 0.95
# Quantities of the transition, with their symbols.
SYMBOLS = {"time": "T", "length": "L"}
# The two readings of T_trans under a displacement boundary, and the columns of each, with those of
# the paper's estimates. The printed slip 2 tau/gamma is used with the level tau_0.
FIRST_STICK, PRINTED_SLIP = "first stick", r"slip $2\tau_0/\gamma$"
PAPER_ESTIMATES = {
    "paper_transition_time": "estimated_time",
    "paper_transition_length": "estimated_length",
}
STICK_COLUMNS = {"transition_time": "time", "transition_length": "length"}
SLIP_COLUMNS = {"slip_time_background": "time", "slip_length_background": "length"}
COLUMNS_BY_CRITERION = {
    FIRST_STICK: STICK_COLUMNS | PAPER_ESTIMATES,
    PRINTED_SLIP: SLIP_COLUMNS | PAPER_ESTIMATES,
}
# Columns of lattices under held stress, which are measured at the last release.
ARREST_COLUMNS = {"last_release_distance": "covered", "last_release_time": "time"}
ARREST_COLUMNS |= {"last_release_length": "length"}


class Runs(NamedTuple):
    """Runs at one combination of choices: one table for each lattice, or one exact table."""

    choice: Chosen
    tables: list[pd.DataFrame]


def shared_choices(table: pd.DataFrame) -> Chosen:
    """Return the release rule and the damping ratio, which all runs of a table share."""
    return {name: table[name].iloc[0] for name in ("release", "damping_ratio")}


def lattice_runs(tables: list[pd.DataFrame]) -> Runs:
    """Return simulated runs with their choices."""
    return Runs(shared_choices(tables[0]) | {"solution": "lattice"}, tables)


def simulated_runs(evidence: Evidence, boundary: str) -> list[Runs]:
    """Return the runs of figure 5, and the undamped runs of figures 10 and 11."""
    sweeps = {
        f"scaling_{boundary}": NO_BACKWARD_SLIP,
        f"damping_{boundary}": f"{NO_BACKWARD_SLIP} and damping_ratio == 0",
    }
    lattices = [evidence.lattices(name, where=condition) for name, condition in sweeps.items()]
    return [lattice_runs(tables) for tables in lattices if len(tables[0])]


def exact_runs(evidence: Evidence, boundary: str) -> list[Runs]:
    """Return exact solutions at each combination of choices; those of figure 5 come first."""
    names, ours = (
        ["release", "damping_ratio"],
        shared_choices(evidence.tables[f"scaling_{boundary}"]),
    )
    if boundary == "stress":
        names += ["nucleation", "fraction"]
        ours["fraction"] = SHOWN_FRACTION
    table = evidence.tables["open_choices"].query(
        f"boundary == {boundary!r} and {NO_BACKWARD_SLIP}"
    )
    combinations = []
    for values, rows in table.groupby(names):
        choice: Chosen = dict(zip(names, values, strict=True))
        combinations.append(Runs(choice | {"solution": "exact"}, [rows]))
    return sorted(combinations, key=lambda runs: not ours.items() <= runs.choice.items())


@cache
def transitions(evidence: Evidence) -> list[Runs]:
    """Return runs under a displacement boundary, for both readings of T_trans.

    Exact solutions are measured at the first stick only, lattices also at the printed slip.
    """
    lattices = simulated_runs(evidence, "displacement")
    runs = {FIRST_STICK: lattices + exact_runs(evidence, "displacement"), PRINTED_SLIP: lattices}
    out = []
    for criterion, of_criterion in runs.items():
        for choice, tables in of_criterion:
            renamed = [table.rename(columns=COLUMNS_BY_CRITERION[criterion]) for table in tables]
            out.append(Runs(choice | {"criterion": criterion}, renamed))
    return out


@cache
def arrests(evidence: Evidence) -> list[Runs]:
    """Return runs under held stress, measured when the left front has covered part of |x_minus|."""
    last: Chosen = {"nucleation": "Gaussian", "fraction": LAST_RELEASE_FRACTION}
    exact = exact_runs(evidence, "stress")
    columns = COLUMNS_BY_CRITERION[FIRST_STICK]
    out = [Runs(choice, [widest_at_each_level(rows, columns)]) for choice, (rows,) in exact]
    for choice, tables in simulated_runs(evidence, "stress"):
        out.append(
            Runs(choice | last, [widest_at_each_level(table, ARREST_COLUMNS) for table in tables])
        )
    return out


def widest_at_each_level(table: pd.DataFrame, names: Mapping[str, str]) -> pd.DataFrame:
    """Return one run for each level, with the estimates for the distance that it has covered."""
    # The width is the only length, so runs of one level differ in scale only.
    table = table.sort_values("width").drop_duplicates("left", keep="last").rename(columns=names)
    if "covered" not in table:
        # The paper estimates the time to cover the whole distance at speed 1, so both are equal.
        table = table.assign(covered=table["fraction"] * table["estimated_time"])
    return table.assign(estimated_time=table["covered"], estimated_length=2.0 * table["covered"])


def medians(combinations: Sequence[Combination]) -> dict[float | str, float]:
    """Return the median ratio for each covered fraction.

    All other choices are fixed to those of the first combination.
    """
    first = combinations[0].choice
    choice = {name: first[name] for name in ("release", "damping_ratio", "nucleation")}
    return {
        one.choice["fraction"]: one.claim.fields().get("measured", NAN)
        for one in combinations
        if choice.items() <= one.choice.items()
    }


def fraction_medians(combinations: Sequence[Combination]) -> dict[str, float]:
    """Return the median ratio for each covered fraction, as further numbers of a claim."""
    numbers = medians(combinations).items()
    return dict(sorted((f"median ratio: at {named(part)}", median) for part, median in numbers))


def judge_each(
    runs: Iterable[Runs], judge: Callable[[list[pd.DataFrame]], Claim]
) -> list[Combination]:
    """Judge a claim at each combination."""
    return [Combination(choice, judge(tables)) for choice, tables in runs]


class JudgedEstimate(NamedTuple):
    """An estimate at all combinations, with two comparisons."""

    combinations: list[Combination]
    # Median and largest deviation of lattices from exact theory.
    from_exact: Uncertain
    # Length of the arrow in figure 4 divided by the estimate; empty if figure 4 draws none.
    arrow: dict[str, float]


def judge_estimate(evidence: Evidence, id: str, boundary: str, quantity: str) -> JudgedEstimate:
    """Judge an estimate at each combination of choices."""
    runs = transitions(evidence) if boundary == "displacement" else arrests(evidence)
    columns = quantity, f"estimated_{quantity}"
    combinations = judge_each(runs, lambda tables: evidence.approximate(id, tables, *columns))
    exact = evidence.deviation_from_exact(f"scaling_{boundary}", f"transition_{quantity}")
    arrow = {}
    suffix = "_stress" if boundary == "stress" else ""
    read = evidence.readings.get(f"arrow_{quantity}{suffix}")
    if read:
        scene = evidence.tables[f"space_time_{boundary}"].iloc[0]
        predicted = float(scene[f"paper_transition_{quantity}"])
        arrow["arrow of figure 4 divided by the estimate"] = read["value"] / predicted
        arrow["its reading error"] = read["reading_error"] / predicted
    return JudgedEstimate(combinations, exact, arrow)


def displacement_transition(evidence: Evidence, id: str, quantity: str) -> OverChoices:
    """Judge an estimate under a displacement boundary, at the first stick and at the slip."""
    combinations, exact, arrow = judge_estimate(evidence, id, "displacement", quantity)
    slips = evidence.finest("scaling_displacement").rename(
        columns=COLUMNS_BY_CRITERION[PRINTED_SLIP]
    )
    ratio = ratios(slips, quantity, f"estimated_{quantity}")
    near = (ratio - 1.0).abs() <= evidence.tolerance(id)
    further = {
        f"runs that reach the {PRINTED_SLIP}": float(ratio.count()),
        "in all": float(len(ratio)),
    }
    further |= {"of these within the tolerance": float(near.sum())} | arrow
    template_values = readings_by_name(evidence) | undamped_and_damped(combinations)
    template_values |= {"of_runs": len(ratio), "reach": ratio.count()}
    template_values["reach_literally"] = slips["slip_time_nucleation"].count()
    return over_choices(
        combinations, from_exact=exact, further=further, template_values=template_values
    )


def undamped_and_damped(combinations: Iterable[Combination]) -> dict[str, list[float]]:
    """Return deviations at the first stick: without damping, and by release rule with damping."""
    sizes: dict[str, list[float]] = {"undamped": [], "elastic": [], "total": []}
    for one in combinations:
        choice, deviation = one.choice, one.result["deviation"]
        if choice["criterion"] == FIRST_STICK and deviation is not None:
            part = "undamped" if choice["damping_ratio"] == 0.0 else str(choice["release"])
            sizes[part].append(deviation)
    return sizes


def stress_transition(evidence: Evidence, id: str, quantity: str) -> OverChoices:
    """Judge an estimate under a stress boundary, at each fraction and at the last release."""
    combinations, exact, arrow = judge_estimate(evidence, id, "stress", quantity)
    further = arrow | fraction_medians(combinations)
    return over_choices(combinations, from_exact=exact, further=further)


def scaling(evidence: Evidence, id: str, boundary: str) -> OverChoices:
    """Judge if the transition scales like the paper's estimates of its time T and its length L.

    T and L of the runs are fitted as powers of their estimates, and the exponent should be 1. The
    claim is judged by T or L, whichever has its exponent farther from 1.
    """
    displacement = boundary == "displacement"
    columns = ("left", "gamma") if displacement else ("left",)

    def judge(tables: list[pd.DataFrame]) -> Equation:
        exponents = {
            symbol: exponent(tables, quantity, f"estimated_{quantity}", columns)
            for quantity, symbol in SYMBOLS.items()
        }
        distances = {symbol: abs(value - 1.0) for symbol, (value, _) in exponents.items()}
        symbol = max(distances, key=lambda name: distances[name])
        measured, uncertainty = map(np.atleast_1d, exponents[symbol])
        return Equation(
            tolerance=evidence.tolerance(id),
            predicted=np.ones(1),
            measured=measured,
            uncertainty=uncertainty,
            counts={"runs": len(tables[0])},
            template_values={"symbol": symbol},
        )

    runs = transitions(evidence) if displacement else arrests(evidence)
    return over_choices(judge_each(runs, judge))


def stress_front_speeds_near_one(evidence: Evidence, id: str) -> OverChoices:
    """Judge the mean speeds of both fronts; the front with the larger deviation counts."""

    def judge(tables: list[pd.DataFrame]) -> Approximate:
        left = evidence.approximate(id, tables, "covered / time", "1")
        right = evidence.approximate(id, tables, "(length - covered) / time", "1")
        side, front = ("right", right) if right.median[0] > left.median[0] else ("left", left)
        return replace(front, template_values={"side": side})

    combinations = judge_each(arrests(evidence), judge)
    return over_choices(combinations, further=fraction_medians(combinations))


def transition_time_underestimated(evidence: Evidence, id: str) -> OverChoices:
    """Judge whether the left front takes longer than at speed 1 in each run."""

    def judge(tables: list[pd.DataFrame]) -> Qualitative:
        excesses = [table["time"] / table["covered"] - 1.0 for table in tables[:2]]

        def longer(limit: float) -> Qualitative:
            holds = [(excess > 0.0) & (excess <= limit) for excess in excesses]
            # An exact solution is one table, which agrees with itself.
            return Qualitative(decided=agreed_answers(holds[0], holds[-1]))

        # The tolerance 0 sets no limit. The earlier tolerance limited how much longer it takes.
        return replace(
            longer(np.inf), extra_verdict=lambda limit: longer(limit or np.inf).verdict()
        )

    runs = arrests(evidence)
    exact = [tables[0] for choice, tables in runs if choice["solution"] == "exact"]
    least = min(float((table["time"] / table["covered"]).min()) for table in exact)
    further = {"smallest ratio of the exact solution": least}
    return over_choices(judge_each(runs, judge), further=further)


def front_arrest_position(evidence: Evidence, id: str) -> OverChoices:
    """Judge the position of the last release on the left, compared with x_minus.

    In addition, the exponent must be near 1 and the median gap to x_minus small.
    """
    sweeps = ("scaling_stress", "damping_stress", "space_time_stress", "arrest_profiles")
    covered, predicted = "last_release_distance", "balance_distance"
    allowed = float(evidence.entries[id]["tolerance_exponent"])

    def judge(tables: list[pd.DataFrame]) -> Approximate:
        claim = evidence.approximate(id, tables, covered, predicted)
        gaps = [(table[predicted] - table[covered]).abs().median() for table in tables]
        gap, power = (
            with_grid_uncertainty(tables, gaps),
            exponent(tables, covered, predicted, ("left", "width")),
        )
        further = {"median gap in H, over all sweeps": gap[0], "exponent": power[0]}
        small = rules.within(*gap, MAX_ARREST_GAP)
        template_values = {"near": small, "gap": gap[0], "gap_uncertainty": gap[1]}
        extra = rules.worst([small, rules.within(abs(power[0] - 1.0), power[1], allowed)])
        return replace(
            claim, extra_verdict=lambda _: extra, further=further, template_values=template_values
        )

    tables = evidence.lattices(*sweeps, where=NO_BACKWARD_SLIP)
    shown, ratio = judge(tables), ratios(tables[0], covered, predicted)
    extremes = {"smallest ratio": float(ratio.min()), "largest ratio": float(ratio.max())}
    dampings = {*evidence.tables["open_choices"]["damping_ratio"]} & {*tables[0]["damping_ratio"]}
    runs = []
    for damping in sorted(dampings):
        chosen = tables[0]["damping_ratio"] == damping
        runs.append(lattice_runs([table[chosen.to_numpy()] for table in tables]))
    return over_choices(judge_each(runs, judge), shown, further={**shown.further, **extremes})


def transition_diverges(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether T_trans and L_trans grow at every step down in gamma."""
    answers, exponents = [], []
    for table in evidence.lattices("scaling_displacement")[:2]:
        sequences = table.sort_values("gamma").groupby("left")
        of_levels = [divergence(rows) for _, rows in sequences]
        answers.append([diverges for diverges, _ in of_levels])
        exponents.append([pair for _, pair in of_levels])
    words = r"mean exponent of $\gamma$ in ${}_\mathrm{{trans}}$".format
    means = np.mean(exponents[0], axis=0)
    further = {words(symbol): float(mean) for symbol, mean in zip("TL", means, strict=True)}
    return Qualitative(decided=agreed_answers(*answers), further=further)


def divergence(rows: pd.DataFrame) -> tuple[bool | None, list[float]]:
    """Return whether T and L diverge as gamma falls, and the exponents of gamma.

    Both must fall with gamma, and be negative powers of its three smallest values.
    """
    quantities = ["transition_time", "transition_length"]
    smallest = np.log(rows[["gamma", *quantities]].head(3))
    lines = [fit_line(smallest["gamma"], smallest[quantity]) for quantity in quantities]
    # The exponents must be below zero by three standard errors.
    falls = (rows[quantities].diff()[1:] < 0.0).all(axis=None)
    diverges = bool(falls and all(slope + 3.0 * error < 0.0 for slope, _, error in lines))
    # Fewer than three runs do not decide.
    return diverges if len(rows) >= 3 else None, [slope for slope, *_ in lines]


def rises(table: pd.DataFrame, quantity: str) -> Qualitative:
    """Judge whether a quantity rises at each step up in the pre-stress, at each gamma.

    A step smaller than its uncertainty is undecided.
    """
    unsure = f"uncertainty_{quantity}"
    table = table.assign(**{unsure: table.get(unsure, 0.0)}).sort_values("left")
    decided: list[bool | None] = []
    for _, rows in table.dropna(subset=quantity).groupby("gamma"):
        steps = rows[quantity].diff()[1:]
        uncertainties = rows[unsure].rolling(2).sum()[1:]
        for step, uncertainty in zip(steps, uncertainties, strict=True):
            decided.append(bool(step > 0.0) if abs(step) > uncertainty else None)
    return Qualitative(decided=decided)


def shorter_transition_low_prestress(evidence: Evidence, id: str) -> OverChoices:
    """Judge whether the transition gets longer with the pre-stress."""
    return over_choices(
        judge_each(transitions(evidence), lambda tables: rises(tables[0], "length"))
    )


def pulses_widen_with_prestress(evidence: Evidence, id: str) -> Qualitative:
    """Judge whether the pulse gets wider with the pre-stress."""
    return rises(evidence.finest("any_prestress"), "pulse_width")
