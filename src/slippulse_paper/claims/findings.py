"""Compute the numbers of our findings, which are results that are not statements of the paper.

Most numbers are expressions in manuscript/claims.yaml over the columns of one table. Functions of
this package compute the other numbers; `COMPUTED_FINDINGS` lists them.
"""

from collections.abc import Callable, Mapping, Sequence
from types import SimpleNamespace

import numpy as np
import pandas as pd

from slippulse.measurement.inference import infer_parameters

from ..text.prose import fill, without_missing
from . import layer_claims as layer
from . import rough_claims as rough
from . import transition_claims as transition
from .evidence import Evidence, evaluated, value_of

# The text of a finding of which no number was measured.
NO_NUMBER = "This run has no number for this finding."


def findings(
    evidence: Evidence, damping_ratio: float, entries: Mapping[str, Mapping]
) -> list[dict]:
    """Return each finding with its id, its numbers by name, its text and its source tables.

    damping_ratio : damping ratio of the figures; an expression can use it as ``figures``
    entries : text, source and expressions of each finding, from manuscript/claims.yaml
    """
    all_findings = []
    for id, entry in entries.items():
        # Each of these has a table, and expressions over the columns of this table.
        expression_groups = entry.get("numbers", [])
        values = all_numbers(evidence, damping_ratio, id, expression_groups)
        # In the text the numbers are n.NAME.
        filled = fill(entry["text"], {"n": SimpleNamespace(**values) if values else None})
        text = without_missing(filled) or NO_NUMBER
        tables = [group["table"] for group in expression_groups]
        source = ", ".join([*tables, *entry.get("source", [])])
        all_findings.append({"id": id, "numbers": values, "text": text, "source": source})
    return all_findings


def all_numbers(
    evidence: Evidence, damping_ratio: float, id: str, expression_groups: Sequence[Mapping]
) -> dict[str, float]:
    """Return all numbers of one finding, by name.

    The result is empty if a changed configuration has no runs for some of the numbers.

    damping_ratio : damping ratio of the figures; an expression can use it as ``figures``
    expression_groups : arguments of `numbers_of_table`, one mapping for each table
    """
    values: dict[str, float] = {}
    for group in expression_groups:
        values_of_table = numbers_of_table(evidence, damping_ratio, **group)
        if not values_of_table:
            return {}
        values |= values_of_table
    if id in COMPUTED_FINDINGS:
        computed = COMPUTED_FINDINGS[id](evidence)
        if not computed:
            return {}
        values |= computed
    return values


def numbers_of_table(
    evidence: Evidence, damping_ratio: float, table: str, take: Mapping, where: str = ""
) -> dict[str, float]:
    """Evaluate expressions over the columns of one table; empty if no row is selected.

    damping_ratio : damping ratio of the figures; an expression can use it as ``figures``
    table : name of the table. If it is a simulation that has a grid study, its rows are those of
        `Evidence.finest`: the results of the grid study are added, and flagged runs are left out
    take : expressions by the name of the number
    where : condition that selects rows; all rows if it is empty
    """
    rows = evidence.finest(table) if table in evidence.swept else evidence.tables[table]
    rows = rows.assign(figures=damping_ratio)
    rows = rows[evaluated(rows, where)]
    if rows.empty:
        return {}
    return {name: float(value_of(rows, expression)) for name, expression in take.items()}


def length_changes_by_damping(evidence: Evidence) -> dict[str, float]:
    """Return by how much damping changes L_trans, for each boundary condition.

    The result is empty if a changed configuration has no runs without damping.

    The result contains these numbers:

    ..._change : median ratio of L_trans at the largest damping ratio to L_trans without damping
    ..._scenes : number of scenes that were simulated at several damping ratios
    ..._runs : number of these scenes that have a transition both at the largest damping ratio and
        without damping
    ratio : the largest damping ratio
    """
    values: dict[str, float] = {}
    for boundary in ("displacement", "stress"):
        table = evidence.finest(f"damping_{boundary}")
        table = table.set_index(["left", "width", "gamma", "release", "dx", "damping_ratio"])
        # One row for each scene, and one column for each damping ratio, in ascending order. The
        # length is NaN in a run without a transition.
        lengths = table["transition_length"].unstack()
        if 0.0 not in lengths:
            return {}
        most_damped, undamped = lengths.iloc[:, -1], lengths[0.0]
        ratios = most_damped / undamped
        values[f"{boundary}_change"] = float(ratios.median())
        values[f"{boundary}_runs"] = float(ratios.count())
        values[f"{boundary}_scenes"] = float(len(ratios))
    return values | {"ratio": float(lengths.columns[-1])}


def best_fit(evidence: Evidence) -> dict[str, float | str]:
    """Return the best fit to the published figure, as numbers for the text.

    The result contains these numbers:

    release, ratio : release rule and damping ratio of the fit
    level, gamma : level of the pre-stress and elasticity ratio of the fit
    low, high : ends of the confidence region of the damping ratio at 95 %
    other_low, other_high : the same with the other release rule
    chi_square, degrees : chi-square and degrees of freedom
    difference : chi-square with the other release rule, minus chi-square of the best fit
    """
    fits = infer_parameters(evidence.tables["published_figure"])
    best = fits["best"]
    low, high = best["regions"][0.95]
    other_release = "elastic" if best["release"] == "total" else "total"
    other_low, other_high = fits[other_release]["regions"][0.95]
    return {
        "release": best["release"],
        "chi_square": best["chi2"],
        "degrees": float(best["dof"]),
        "ratio": best["damping_ratio"],
        "level": best["tau0"],
        "gamma": best["gamma"],
        "low": low,
        "high": high,
        "other_low": other_low,
        "other_high": other_high,
        "difference": fits["difference"],
    }


def arrest_time_ratios(evidence: Evidence) -> dict[str, float]:
    """Return the median ratio of the exact arrest time to the paper's estimate.

    There is one median for each fraction of the path at which a front may count as arrested.
    """
    judged = transition.judge_estimate(evidence, "T_trans_stress", "stress", "time")
    medians = {}
    for fraction, median in transition.median_ratio_by_fraction(judged.combinations).items():
        # Leave out the median of lattices. Lattices are measured at the last release, and their
        # median has the text "last release" in place of a fraction.
        if isinstance(fraction, float):
            medians[f"median_{100.0 * fraction:.0f}"] = median
    return medians


def backward_threshold(evidence: Evidence) -> dict[str, float]:
    """Count the runs in which the threshold that the paper prints would let blocks slide back.

    Also return the friction ratio mu_k/(mu_s - mu_k) from which on no block would slide back.
    """
    columns = ["min_stuck_stress", "friction_ratio_needed"]
    runs = pd.concat([evidence.tables[name][columns] for name in evidence.swept])
    # By this threshold, a stuck block slides back as soon as its stress is -1.
    slides_back = runs["min_stuck_stress"] <= -1.0
    return {
        "back": float(slides_back.sum()),
        "runs": float(len(runs)),
        "needed": float(runs["friction_ratio_needed"].max()),
    }


# Findings whose numbers are not expressions over the columns of one table.
COMPUTED_FINDINGS: dict[str, Callable[[Evidence], dict]] = {
    "backward_threshold": backward_threshold,
    "collapse_against_damping": length_changes_by_damping,
    "front_never_arrives": arrest_time_ratios,
    "layer_in_plane": layer.layer_in_plane,
    "pulses_on_rough_prestress": rough.rough_numbers,
    "published_figure_made_with": best_fit,
    # The factor between T_trans and H/c_s.
    "duration_criterion": lambda _: {"factor": float(np.pi / np.sqrt(2.0))},
}
