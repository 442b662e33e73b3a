"""What we found beside the claims: numbers of ours, without a verdict on the paper."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress

import numpy as np

from ..data.prose import fill
from .evidence import Evidence, NoRuns, evaluated
from .inference import inference
from .reading import Numbers
from .transition import medians


def findings(evidence: Evidence, damping_ratio: float, entries: Mapping[str, Mapping]) -> list[dict]:
    """Each finding: id, its numbers by name (none where an altered configuration left no runs), and its text.

    Parameters
    ----------
    damping_ratio : beta/dx of the figures
    entries : per finding, as in manuscript/claims.yaml, its text and the tables that its numbers are taken from

    Raises
    ------
    ValueError
        If a text asks for a number that there is not.
    """
    out = []
    for id, entry in entries.items():
        found: dict = {}
        with suppress(NoRuns):
            for rows in entry.get("numbers", []):
                found |= numbers(evidence, damping_ratio, **rows)
            if id in COMPUTED:
                found |= COMPUTED[id](evidence)
        out.append({"id": id, "numbers": found, "text": fill(entry["text"], {"n": Numbers(found)})})
    return out


def numbers(
    evidence: Evidence, damping_ratio: float, table: str, take: Mapping[str, str], where: str = ""
) -> dict[str, float]:
    """Expressions over columns of the chosen rows of one table; `NoRuns` without rows."""
    rows = evidence.runs(table) if table in evidence.swept else evidence.tables[table]
    rows = rows.assign(figures=damping_ratio)
    if (rows := rows[evaluated(rows, where)]).empty:
        raise NoRuns(table)
    return {name: float(rows.eval(expression, engine="python")) for name, expression in take.items()}


def fractions(evidence: Evidence) -> dict[str, float]:
    """Median ratio of the exact time at each fraction of the way to the predicted one."""
    found = medians(evidence, "time", "distance")
    return {f"median_{100.0 * fraction:.0f}": ratio for fraction, ratio in found.items()}


def collapse(evidence: Evidence) -> dict[str, float]:
    """Median change of L_trans between no damping and the largest ratio, over the scenes that have it at both."""
    out: dict[str, float] = {}
    for boundary in ("displacement", "stress"):
        table = evidence.runs(f"damping_{boundary}").fillna({"gamma": 0.0})
        scenes = ["left", "width", "gamma"]
        lengths = table.pivot(index=scenes, columns="damping_ratio", values="transition_length")
        change = lengths.iloc[:, -1] / lengths.iloc[:, 0]
        out[f"{boundary}_change"] = float(change.median())
        out[f"{boundary}_runs"], out[f"{boundary}_scenes"] = float(change.count()), float(len(change))
    return out | {"ratio": float(lengths.columns[-1])}


def best_fit(evidence: Evidence) -> dict[str, float | str]:
    """What the published figure was made with: best fit, confidence region, how much worse the other rule is."""
    found = inference(evidence.tables["published_figure"])
    best = found["best"]
    low, high = best["regions"][0.95]["damping_ratio"]
    return {
        "release": best["release"], "chi_square": best["chi2"], "degrees": float(best["dof"]),
        "ratio": best["damping_ratio"], "low": low, "high": high, "difference": found["difference"],
    }  # fmt: skip


# Numbers that are no expression over the columns of one table.
COMPUTED: dict[str, Callable[[Evidence], dict]] = {
    "collapse_against_damping": collapse,
    "front_never_arrives": fractions,
    "published_figure_made_with": best_fit,
    "duration_criterion": lambda _: {"factor": float(np.pi / np.sqrt(2.0))},
}
