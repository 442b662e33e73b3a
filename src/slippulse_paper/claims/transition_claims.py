"""Claims about the transition and about where a front ends, at every choice that is left open."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import NamedTuple

import numpy as np
import pandas as pd

from slippulse.measurement.front_paths import fit_line

from . import rules
from .choices import LAST, Chosen, Combination, OverChoices, named, over_choices
from .evidence import Evidence, agreeing, exponent, ratios, studied
from .kinds import NAN, Approximate, Claim, Equation, Qualitative
from .rules import Uncertain
from .space_time_claims import drawn

# At or below -1 the printed threshold, which has two sides, lets the pre-stress itself slide back.
INSIDE = "left > -1"
# The smallest length of the model, in H: a front that ends so near to x_minus ends there.
GAP = 1.0
# Fraction of the way whose numbers stand with a claim.
SHOWN = 0.95
# Quantities of the transition, with their symbols.
SYMBOLS = {"time": "T", "length": "L"}
# The two readings of T_trans under a displacement boundary, and the columns that have them, with
# the paper's estimates. At the nucleation point the printed slip 2 tau/gamma is taken with the
# level tau_0.
STICK, SLIP = "first stick", r"slip $2\tau_0/\gamma$"
PAPER = {"paper_transition_time": "estimated_time", "paper_transition_length": "estimated_length"}
CRITERIA = {
    STICK: {"transition_time": "time", "transition_length": "length"} | PAPER,
    SLIP: {"slip_time_background": "time", "slip_length_background": "length"} | PAPER,
}
# Columns under held stress: a solution is at a fraction of the way, a lattice at the last release.
LAST_RELEASE = {"last_release_distance": "covered", "last_release_time": "time"}
LAST_RELEASE |= {"last_release_length": "length"}


class Runs(NamedTuple):
    """Runs at one combination of choices: a table for each lattice, or one of exact solutions."""

    choice: Chosen
    tables: list[pd.DataFrame]


def shared(table: pd.DataFrame) -> Chosen:
    """The release rule and the damping ratio that runs have in common."""
    return {name: table[name].iloc[0] for name in ("release", "damping_ratio")}


def on_lattices(tables: list[pd.DataFrame]) -> Runs:
    """Simulated runs with their choices."""
    return Runs(shared(tables[0]) | {"solution": "lattice"}, tables)


def simulated(evidence: Evidence, boundary: str) -> list[Runs]:
    """Runs of figure 5, and the undamped ones of the figures with more damping."""
    sweeps = {
        f"scaling_{boundary}": INSIDE,
        f"damping_{boundary}": f"{INSIDE} and damping_ratio == 0",
    }
    lattices = [evidence.lattices(name, where=condition) for name, condition in sweeps.items()]
    return [on_lattices(tables) for tables in lattices if len(tables[0])]


def solved(evidence: Evidence, boundary: str) -> list[Runs]:
    """The exact solution at each combination of choices; first ours, as in figure 5."""
    names, ours = ["release", "damping_ratio"], shared(evidence.tables[f"scaling_{boundary}"])
    if boundary == "stress":
        names += ["nucleation", "fraction"]
        ours["fraction"] = SHOWN
    table = evidence.tables["open_choices"].query(f"boundary == {boundary!r} and {INSIDE}")
    combinations = []
    for values, rows in table.groupby(names):
        choice: Chosen = dict(zip(names, values, strict=True))
        combinations.append(Runs(choice | {"solution": "exact"}, [rows]))
    return sorted(combinations, key=lambda runs: not ours.items() <= runs.choice.items())


@cache
def transitions(evidence: Evidence) -> list[Runs]:
    """Runs under a displacement boundary, by the first stick, and on lattices by the slip too."""
    lattices = simulated(evidence, "displacement")
    runs = {STICK: lattices + solved(evidence, "displacement"), SLIP: lattices}
    out = []
    for criterion, of_criterion in runs.items():
        for choice, tables in of_criterion:
            renamed = [table.rename(columns=CRITERIA[criterion]) for table in tables]
            out.append(Runs(choice | {"criterion": criterion}, renamed))
    return out


@cache
def arrests(evidence: Evidence) -> list[Runs]:
    """Runs of the left front under held stress, for the part of |x_minus| that is covered."""
    last: Chosen = {"nucleation": "Gaussian", "fraction": LAST}
    exact = solved(evidence, "stress")
    out = [Runs(choice, [widest(rows, CRITERIA[STICK])]) for choice, (rows,) in exact]
    for choice, tables in simulated(evidence, "stress"):
        out.append(Runs(choice | last, [widest(table, LAST_RELEASE) for table in tables]))
    return out


def widest(table: pd.DataFrame, names: Mapping[str, str]) -> pd.DataFrame:
    """The run of each level with the widest nucleation, with estimates by what is covered."""
    # The width is the only length, so that runs of one level do not depend on it.
    table = table.sort_values("width").drop_duplicates("left", keep="last").rename(columns=names)
    if "covered" not in table:
        # The paper's estimate of the time is the whole way, at speed 1.
        table = table.assign(covered=table["fraction"] * table["estimated_time"])
    return table.assign(estimated_time=table["covered"], estimated_length=2.0 * table["covered"])


def medians(combinations: Sequence[Combination]) -> dict[float | str, float]:
    """The median ratio by fraction of the way, the other choices being those of the first."""
    first = combinations[0].choice
    choice = {name: first[name] for name in ("release", "damping_ratio", "nucleation")}
    return {
        one.choice["fraction"]: one.claim.fields().get("measured", NAN)
        for one in combinations
        if choice.items() <= one.choice.items()
    }


def fraction_medians(combinations: Sequence[Combination]) -> dict[str, float]:
    """The median ratio at each fraction of the way, as further numbers of a claim."""
    numbers = medians(combinations).items()
    return dict(sorted((f"median ratio: at {named(part)}", median) for part, median in numbers))


def judged(runs: Iterable[Runs], judge: Callable[[list[pd.DataFrame]], Claim]) -> list[Combination]:
    """A claim judged at each combination."""
    return [Combination(choice, judge(tables)) for choice, tables in runs]


def estimated(
    evidence: Evidence, id: str, boundary: str, quantity: str
) -> tuple[list[Combination], Uncertain, dict[str, float]]:
    """An estimate at each combination, the exact theory beside, and the arrow drawn of it."""
    runs = transitions(evidence) if boundary == "displacement" else arrests(evidence)
    columns = quantity, f"estimated_{quantity}"
    combinations = judged(runs, lambda tables: evidence.approximate(id, tables, *columns))
    exact = evidence.deviation_from_exact(f"scaling_{boundary}", f"transition_{quantity}")
    arrow = {}
    suffix = "_stress" if boundary == "stress" else ""
    read = evidence.readings.get(f"arrow_{quantity}{suffix}")
    if read:
        scene = evidence.tables[f"space_time_{boundary}"].iloc[0]
        predicted = float(scene[f"paper_transition_{quantity}"])
        arrow["arrow of figure 4 over the estimate"] = read["value"] / predicted
        arrow["its reading error"] = read["reading_error"] / predicted
    return combinations, exact, arrow


def held_displacement(evidence: Evidence, id: str, quantity: str) -> OverChoices:
    """An estimate under a displacement boundary, by the first stick and by the slip."""
    combinations, exact, arrow = estimated(evidence, id, "displacement", quantity)
    slips = evidence.finest("scaling_displacement").rename(columns=CRITERIA[SLIP])
    ratio = ratios(slips, quantity, f"estimated_{quantity}")
    near = (ratio - 1.0).abs() <= evidence.tolerance(id)
    further = {f"runs that reach the {SLIP}": float(ratio.count()), "in all": float(len(ratio))}
    further |= {"of these within the tolerance": float(near.sum())} | arrow
    told = drawn(evidence) | undamped_and_damped(combinations)
    told |= {"of_runs": len(ratio), "reach": ratio.count()}
    told["reach_literally"] = slips["slip_time_nucleation"].count()
    return over_choices(combinations, from_exact=exact, further=further, told=told)


def undamped_and_damped(combinations: Iterable[Combination]) -> dict[str, list[float]]:
    """The deviations by the first stick without damping and, by release rule, with it."""
    sizes: dict[str, list[float]] = {"undamped": [], "elastic": [], "total": []}
    for one in combinations:
        choice, deviation = one.choice, one.result["deviation"]
        if choice["criterion"] == STICK and deviation is not None:
            part = "undamped" if choice["damping_ratio"] == 0.0 else str(choice["release"])
            sizes[part].append(deviation)
    return sizes


def held_stress(evidence: Evidence, id: str, quantity: str) -> OverChoices:
    """An estimate under a stress boundary, at each fraction of the way and at the last release."""
    combinations, exact, arrow = estimated(evidence, id, "stress", quantity)
    further = arrow | fraction_medians(combinations)
    return over_choices(combinations, from_exact=exact, further=further)


def scaling(evidence: Evidence, id: str, boundary: str) -> OverChoices:
    """The exponents of T and L over their estimates; that which is farther from 1 counts."""
    displacement = boundary == "displacement"
    columns = ("left", "gamma") if displacement else ("left",)

    def judge(tables: list[pd.DataFrame]) -> Equation:
        exponents = {
            symbol: exponent(tables, quantity, f"estimated_{quantity}", columns)
            for quantity, symbol in SYMBOLS.items()
        }
        symbol = max(exponents, key=lambda name: abs(exponents[name][0] - 1.0))
        measured, uncertainty = map(np.atleast_1d, exponents[symbol])
        return Equation(
            tolerance=evidence.tolerance(id),
            predicted=np.ones(1),
            measured=measured,
            uncertainty=uncertainty,
            counts={"runs": len(tables[0])},
            told={"symbol": symbol},
        )

    runs = transitions(evidence) if displacement else arrests(evidence)
    return over_choices(judged(runs, judge))


def stress_front_speeds_near_one(evidence: Evidence, id: str) -> OverChoices:
    """Mean speeds of both fronts; the front with the larger deviation counts."""

    def judge(tables: list[pd.DataFrame]) -> Approximate:
        left = evidence.approximate(id, tables, "covered / time", "1")
        right = evidence.approximate(id, tables, "(length - covered) / time", "1")
        side, front = ("right", right) if right.median[0] > left.median[0] else ("left", left)
        return replace(front, told={"side": side})

    combinations = judged(arrests(evidence), judge)
    return over_choices(combinations, further=fraction_medians(combinations))


def transition_time_underestimated(evidence: Evidence, id: str) -> OverChoices:
    """The left front takes longer than at speed 1 for the part that it has covered, in each run."""

    def judge(tables: list[pd.DataFrame]) -> Qualitative:
        over = [table["time"] / table["covered"] - 1.0 for table in tables[:2]]

        def longer(most: float) -> Qualitative:
            holds = [(excess > 0.0) & (excess <= most) for excess in over]
            # An exact solution is one table, which agrees with itself.
            return Qualitative(decided=agreeing(holds[0], holds[-1]))

        # The tolerance is 0; the earlier one was for how much longer it may take.
        return replace(longer(np.inf), besides=lambda most: longer(most or np.inf).verdict())

    runs = arrests(evidence)
    exact = [tables[0] for choice, tables in runs if choice["solution"] == "exact"]
    least = min(float((table["time"] / table["covered"]).min()) for table in exact)
    further = {"smallest ratio of the exact solution": least}
    return over_choices(judged(runs, judge), further=further)


def front_arrest_position(evidence: Evidence, id: str) -> OverChoices:
    """The last release on the left over |x_minus|, with an exponent near 1 and a small distance."""
    sweeps = ("scaling_stress", "damping_stress", "space_time_stress", "arrest_profiles")
    covered, predicted = "last_release_distance", "balance_distance"
    allowed = float(evidence.entries[id]["tolerance_exponent"])

    def judge(tables: list[pd.DataFrame]) -> Approximate:
        claim = evidence.approximate(id, tables, covered, predicted)
        gaps = [(table[predicted] - table[covered]).abs().median() for table in tables]
        gap, power = studied(tables, gaps), exponent(tables, covered, predicted, ("left", "width"))
        further = {"median gap in H, over all sweeps": gap[0], "exponent": power[0]}
        small = rules.within(*gap, GAP)
        told = {"near": small, "gap": gap[0], "gap_uncertainty": gap[1]}
        besides = rules.worst([small, rules.within(abs(power[0] - 1.0), power[1], allowed)])
        return replace(claim, besides=lambda _: besides, further=further, told=told)

    tables = evidence.lattices(*sweeps, where=INSIDE)
    shown, ratio = judge(tables), ratios(tables[0], covered, predicted)
    extremes = {"smallest ratio": float(ratio.min()), "largest ratio": float(ratio.max())}
    dampings = {*evidence.tables["open_choices"]["damping_ratio"]} & {*tables[0]["damping_ratio"]}
    runs = []
    for damping in sorted(dampings):
        chosen = tables[0]["damping_ratio"] == damping
        runs.append(on_lattices([table[chosen.to_numpy()] for table in tables]))
    return over_choices(judged(runs, judge), shown, further={**shown.further, **extremes})


def transition_diverges(evidence: Evidence, id: str) -> Qualitative:
    """T_trans and L_trans grow at every step down in gamma."""
    answers, exponents = [], []
    for table in evidence.lattices("scaling_displacement")[:2]:
        sequences = table.sort_values("gamma").groupby("left")
        of_levels = [divergence(rows) for _, rows in sequences]
        answers.append([diverges for diverges, _ in of_levels])
        exponents.append([pair for _, pair in of_levels])
    words = r"mean exponent of $\gamma$ in ${}_\mathrm{{trans}}$".format
    means = np.mean(exponents[0], axis=0)
    further = {words(symbol): float(mean) for symbol, mean in zip("TL", means, strict=True)}
    return Qualitative(decided=agreeing(*answers), further=further)


def divergence(rows: pd.DataFrame) -> tuple[bool | None, list[float]]:
    """Whether T and L fall with gamma, at its three smallest values as powers; the exponents."""
    quantities = ["transition_time", "transition_length"]
    smallest = np.log(rows[["gamma", *quantities]].head(3))
    lines = [fit_line(smallest["gamma"], smallest[quantity]) for quantity in quantities]
    # Powers are below zero by three standard errors.
    falls = (rows[quantities].diff()[1:] < 0.0).all(axis=None)
    diverges = bool(falls and all(slope + 3.0 * error < 0.0 for slope, _, error in lines))
    # Fewer than three runs leave it open.
    return diverges if len(rows) >= 3 else None, [slope for slope, *_ in lines]


def rises(table: pd.DataFrame, quantity: str) -> Qualitative:
    """At each gamma a step up in the pre-stress, if above its uncertainty, raises a quantity."""
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
    """The transition gets longer with the pre-stress."""
    return over_choices(judged(transitions(evidence), lambda tables: rises(tables[0], "length")))


def pulses_widen_with_prestress(evidence: Evidence, id: str) -> Qualitative:
    """The pulse gets wider with the pre-stress."""
    return rises(evidence.finest("any_prestress"), "pulse_width")
