"""Compute findings: results of our own without a verdict on the paper.

Most numbers are expressions in manuscript/claims.yaml over the columns of one table. The functions
here compute the others; `COMPUTED_FINDINGS` lists them.
"""

from collections.abc import Callable, Mapping, Sequence
from types import SimpleNamespace

import numpy as np
import pandas as pd

from slippulse.measurement.inference import infer_parameters

from ..text.prose import fill
from . import layer_claims as layer
from . import rough_claims as rough
from . import transition_claims as transition
from .evidence import Evidence, evaluated, value_of


def findings(
    evidence: Evidence, damping_ratio: float, entries: Mapping[str, Mapping]
) -> list[dict]:
    """Return each finding with its id, its numbers by name, its text and its source tables.

    damping_ratio : that of the figures, which expressions may use
    entries : text, source and expressions of each finding, from manuscript/claims.yaml
    """
    all_findings = []
    for id, entry in entries.items():
        # Each row of an entry has a table and expressions over its columns.
        expressions = entry.get("numbers", [])
        values = all_numbers(evidence, damping_ratio, id, expressions)
        # In the text the numbers are n.NAME.
        text = fill(entry["text"], {"n": SimpleNamespace(**values) if values else None})
        tables = [row["table"] for row in expressions]
        source = ", ".join([*tables, *entry.get("source", [])])
        all_findings.append({"id": id, "numbers": values, "text": text, "source": source})
    return all_findings


def all_numbers(
    evidence: Evidence, damping_ratio: float, id: str, expressions: Sequence[Mapping]
) -> dict[str, float]:
    """Return the numbers of one finding: those of its expressions, and those computed here.

    There are none at all if an altered configuration leaves no runs for some of them.
    """
    values: dict[str, float] = {}
    for row in expressions:
        part = numbers(evidence, damping_ratio, **row)
        if not part:
            return {}
        values |= part
    if id in COMPUTED_FINDINGS:
        part = COMPUTED_FINDINGS[id](evidence)
        if not part:
            return {}
        values |= part
    return values


def numbers(
    evidence: Evidence, damping_ratio: float, table: str, take: Mapping, where: str = ""
) -> dict[str, float]:
    """Evaluate expressions over the columns of one table; empty if no row is selected.

    table : name of the table
    take : expressions by the name of the number
    where : condition that selects rows; all rows if it is empty
    """
    rows = evidence.finest(table) if table in evidence.swept else evidence.tables[table]
    # In expressions "figures" is the damping ratio of the figures.
    rows = rows.assign(figures=damping_ratio)
    rows = rows[evaluated(rows, where)]
    if rows.empty:
        return {}
    return {name: float(value_of(rows, expression)) for name, expression in take.items()}


def collapse(evidence: Evidence) -> dict[str, float]:
    """Return the median factor by which damping changes L_trans, for both boundary conditions.

    It compares no damping with the largest damping ratio, over the scenes that have both.
    """
    out: dict[str, float] = {}
    for boundary in ("displacement", "stress"):
        table = evidence.finest(f"damping_{boundary}").fillna({"gamma": 0.0})
        table = table.set_index(["left", "width", "gamma", "damping_ratio"])
        # One row for each scene, and one column for each damping ratio, in ascending order.
        lengths = table["transition_length"].unstack()
        if lengths.empty:
            return {}
        change = lengths.iloc[:, -1] / lengths.iloc[:, 0]
        out[f"{boundary}_change"] = float(change.median())
        out[f"{boundary}_runs"] = float(change.count())
        out[f"{boundary}_scenes"] = float(len(change))
    return out | {"ratio": float(lengths.columns[-1])}


def best_fit(evidence: Evidence) -> dict[str, float | str]:
    """Return the best fit to the published figure, as numbers for the text.

    low, high : ends of the confidence region of the damping ratio
    difference : how much larger chi-square is with the other release rule
    """
    fits = infer_parameters(evidence.tables["published_figure"])
    best = fits["best"]
    low, high = best["regions"][0.95]
    return {
        "release": best["release"],
        "chi_square": best["chi2"],
        "degrees": float(best["dof"]),
        "ratio": best["damping_ratio"],
        "low": low,
        "high": high,
        "difference": fits["difference"],
    }


def never_arrives(evidence: Evidence) -> dict[str, float]:
    """Return the median of the exact time divided by the paper's estimate.

    There is one median for each fraction of the path that counts as arrest.
    """
    judged = transition.judge_estimate(evidence, "T_trans_stress", "stress", "time")
    medians = {}
    for fraction, median in transition.medians(judged.combinations).items():
        # The last release is a text instead of a fraction, and belongs to lattices.
        if isinstance(fraction, float):
            medians[f"median_{100.0 * fraction:.0f}"] = median
    return medians


def backward_threshold(evidence: Evidence) -> dict[str, float]:
    """Count runs in which the printed threshold would let blocks slide back.

    Also return the friction ratio above which no block would.
    """
    columns = ["min_stuck_stress", "friction_ratio_needed"]
    runs = pd.concat([evidence.tables[name][columns] for name in evidence.swept])
    slides_back = runs["min_stuck_stress"] <= -1.0
    return {
        "back": float(slides_back.sum()),
        "runs": float(len(runs)),
        "needed": float(runs["friction_ratio_needed"].max()),
    }


# Findings whose numbers are not expressions over the columns of one table.
COMPUTED_FINDINGS: dict[str, Callable[[Evidence], dict]] = {
    "backward_threshold": backward_threshold,
    "collapse_against_damping": collapse,
    "front_never_arrives": never_arrives,
    "layer_in_plane": layer.layer_in_plane,
    "pulses_on_rough_prestress": rough.rough_numbers,
    "published_figure_made_with": best_fit,
    # The factor between T_trans and H/c_s.
    "duration_criterion": lambda _: {"factor": float(np.pi / np.sqrt(2.0))},
}
