"""Findings: numbers of our own that stand beside the claims, without a verdict."""

from collections.abc import Callable, Mapping
from itertools import chain
from types import SimpleNamespace

import numpy as np
import pandas as pd

from slippulse.measurement.inference import infer_parameters

from ..text.prose import fill
from . import layer_claims as layer
from . import transition_claims as transition
from .evidence import Evidence, evaluated, value_of


def findings(
    evidence: Evidence, damping_ratio: float, entries: Mapping[str, Mapping]
) -> list[dict]:
    """Each finding with its id, its numbers by name, if there are runs, its text and its tables."""
    out = []
    for id, entry in entries.items():
        rows = entry.get("numbers", [])
        parts = [numbers(evidence, damping_ratio, **row) for row in rows]
        if id in COMPUTED and all(parts):
            parts.append(COMPUTED[id](evidence))
        # An altered configuration may have left no runs to take some of them from.
        values = dict(chain.from_iterable(part.items() for part in parts)) if all(parts) else {}
        text = fill(entry["text"], {"n": SimpleNamespace(**values) if values else None})
        source = ", ".join([*(row["table"] for row in rows), *entry.get("source", [])])
        out.append({"id": id, "numbers": values, "text": text, "source": source})
    return out


def numbers(
    evidence: Evidence, ratio: float, table: str, take: Mapping, where: str = ""
) -> dict[str, float]:
    """Expressions over columns of the chosen rows of one table; nothing without rows."""
    rows = evidence.finest(table) if table in evidence.swept else evidence.tables[table]
    rows = rows.assign(figures=ratio)
    rows = rows[evaluated(rows, where)]
    expressions = take.items() if len(rows) else ()
    return {name: float(value_of(rows, expression)) for name, expression in expressions}


def collapse(evidence: Evidence) -> dict[str, float]:
    """Median change of L_trans between no damping and the largest ratio, over scenes with both."""
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
    """The parameters of the published figure: best fit, confidence region, the other rule."""
    fits = infer_parameters(evidence.tables["published_figure"])
    best = fits["best"]
    low, high = best["regions"][0.95]
    out = {"release": best["release"], "chi_square": best["chi2"], "degrees": float(best["dof"])}
    out |= {"ratio": best["damping_ratio"], "low": low, "high": high}
    return out | {"difference": fits["difference"]}


def never_arrives(evidence: Evidence) -> dict[str, float]:
    """Median ratio of the exact time at each fraction of the way to the predicted one."""
    combinations, *_ = transition.estimated(evidence, "T_trans_stress", "stress", "time")
    medians = transition.medians(combinations).items()
    # The last release, a text, is of a lattice.
    return {
        f"median_{100.0 * part:.0f}": median for part, median in medians if isinstance(part, float)
    }


def backward_threshold(evidence: Evidence) -> dict[str, float]:
    """Runs in which blocks would slide back at the printed threshold, and the friction for none."""
    columns = ["min_stuck_stress", "friction_ratio_needed"]
    runs = pd.concat([evidence.tables[name][columns] for name in evidence.swept])
    reverse = (runs["min_stuck_stress"] <= -1.0).sum()
    needed = float(runs["friction_ratio_needed"].max())
    return {"back": float(reverse), "runs": float(len(runs)), "needed": needed}


# Findings with numbers that are no expression over the columns of one table.
COMPUTED: dict[str, Callable[[Evidence], dict]] = {
    "backward_threshold": backward_threshold,
    "collapse_against_damping": collapse,
    "front_never_arrives": never_arrives,
    "layer_in_plane": layer.layer_in_plane,
    "published_figure_made_with": best_fit,
    # Between the two criteria of the duration.
    "duration_criterion": lambda _: {"factor": float(np.pi / np.sqrt(2.0))},
}
