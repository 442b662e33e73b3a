"""Compute findings: results of our own without a verdict on the paper.

Most numbers are expressions in manuscript/claims.yaml over the columns of one table. The functions
here compute the others; `COMPUTED_FINDINGS` lists them.
"""

from collections.abc import Callable, Mapping
from itertools import chain
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

    A finding has no numbers if the configuration leaves no runs for some of them.
    """
    out = []
    for id, entry in entries.items():
        rows = entry.get("numbers", [])
        parts = [numbers(evidence, damping_ratio, **row) for row in rows]
        if id in COMPUTED_FINDINGS and all(parts):
            parts.append(COMPUTED_FINDINGS[id](evidence))
        # An altered configuration may leave no runs for some of the numbers.
        values = dict(chain.from_iterable(part.items() for part in parts)) if all(parts) else {}
        text = fill(entry["text"], {"n": SimpleNamespace(**values) if values else None})
        source = ", ".join([*(row["table"] for row in rows), *entry.get("source", [])])
        out.append({"id": id, "numbers": values, "text": text, "source": source})
    return out


def numbers(
    evidence: Evidence, ratio: float, table: str, take: Mapping, where: str = ""
) -> dict[str, float]:
    """Evaluate expressions over columns of selected rows of one table; empty without rows."""
    rows = evidence.finest(table) if table in evidence.swept else evidence.tables[table]
    rows = rows.assign(figures=ratio)
    rows = rows[evaluated(rows, where)]
    expressions = take.items() if len(rows) else ()
    return {name: float(value_of(rows, expression)) for name, expression in expressions}


def collapse(evidence: Evidence) -> dict[str, float]:
    """Return the median factor by which damping changes L_trans, for both boundary conditions.

    It compares no damping with the largest damping ratio, over the scenes that have both.
    """
    out: dict[str, float] = {}
    for boundary in ("displacement", "stress"):
        table = evidence.finest(f"damping_{boundary}").fillna({"gamma": 0.0})
        table = table.set_index(["left", "width", "gamma", "damping_ratio"])
        lengths = table["transition_length"].unstack()
        if lengths.empty:
            return {}
        change = lengths.iloc[:, -1] / lengths.iloc[:, 0]
        out[f"{boundary}_change"] = float(change.median())
        out[f"{boundary}_runs"] = float(change.count())
        out[f"{boundary}_scenes"] = float(len(change))
    return out | {"ratio": float(lengths.columns[-1])}


def best_fit(evidence: Evidence) -> dict[str, float | str]:
    """Return the best fit to the published figure, its confidence region, and the other rule."""
    fits = infer_parameters(evidence.tables["published_figure"])
    best = fits["best"]
    low, high = best["regions"][0.95]
    out = {"release": best["release"], "chi_square": best["chi2"], "degrees": float(best["dof"])}
    out |= {"ratio": best["damping_ratio"], "low": low, "high": high}
    return out | {"difference": fits["difference"]}


def never_arrives(evidence: Evidence) -> dict[str, float]:
    """Return the median of exact divided by predicted time for each fraction of the distance."""
    combinations, *_ = transition.judge_estimate(evidence, "T_trans_stress", "stress", "time")
    medians = transition.medians(combinations).items()
    # The last release is a text instead of a fraction, and belongs to lattices.
    return {
        f"median_{100.0 * part:.0f}": median for part, median in medians if isinstance(part, float)
    }


def backward_threshold(evidence: Evidence) -> dict[str, float]:
    """Count runs in which the printed threshold would let blocks slide back.

    Also return the friction ratio above which no block would.
    """
    columns = ["min_stuck_stress", "friction_ratio_needed"]
    runs = pd.concat([evidence.tables[name][columns] for name in evidence.swept])
    reverse = (runs["min_stuck_stress"] <= -1.0).sum()
    needed = float(runs["friction_ratio_needed"].max())
    return {"back": float(reverse), "runs": float(len(runs)), "needed": needed}


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
