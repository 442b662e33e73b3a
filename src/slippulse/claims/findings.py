"""What we found beside the claims: numbers of ours, without a verdict on the paper."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import suppress

import numpy as np

from ..data.prose import fill
from .evidence import Evidence, NoRuns, deviations, ratios
from .inference import inference
from .pulses import UNDAMPED
from .reading import Numbers
from .transition import INSIDE, LAST, arrests, at_ours

# Pre-stress at which the effect of damping on the front speed is shown.
LEVEL = 0.6


def findings(evidence: Evidence, damping_ratio: float, texts: Mapping[str, str]) -> list[dict]:
    """Each finding: id, its numbers by name (none where an altered configuration left no runs), and its text.

    Parameters
    ----------
    damping_ratio : beta/dx of the figures
    texts : per finding, Markdown with expressions over its numbers `n`

    Raises
    ------
    ValueError
        If the texts are not about the same findings, or ask for a number that there is not.
    """
    if odd := sorted({*FINDINGS} ^ {*texts}):
        raise ValueError(f"findings: {', '.join(odd)}; allowed: the same in the texts and in the code")
    out = []
    for id, find in FINDINGS.items():
        found: Mapping = {}
        with suppress(NoRuns):
            found = find(evidence, damping_ratio)
        out.append({"id": id, "numbers": found, "text": fill(texts[id], {"n": Numbers(found)})})
    return out


def damped_pulse(evidence: Evidence, ratio: float) -> dict[str, float]:
    """Largest deviation of each undamped formula at the figures' damping, and of the exact theory with damping."""
    table = evidence.runs("steady_displacement")
    off = (table["damping_ratio"] - ratio).abs()
    table = table[off == off.min()]
    out = {"damping_ratio": float(table["damping_ratio"].iloc[0])}
    quantities = ("front_speed_right", "pulse_peak_velocity", "pulse_width", "pulse_slip")
    for name, quantity in zip(("speed", "peak", "width", "slip"), quantities, strict=True):
        for who in ("paper", "exact"):
            out[f"{name}_{who}"] = float(np.max(deviations(table, quantity, f"{who}_{quantity}")))
    return out


def third_parameter(evidence: Evidence, _: float) -> dict[str, float]:
    """Exact front speeds at one pre-stress, without damping and at the largest damping ratio of the collapses."""
    ratio = float(evidence.tables["damping_displacement"]["damping_ratio"].max())
    table = evidence.tables["front_speed"].query(f"right == {LEVEL} and release == 'total'")
    speeds = table.groupby("damping_ratio")["exact_front_speed_right"].first().to_dict()
    if not {0.0, ratio} <= {*speeds}:
        raise NoRuns("front_speed")
    return {"level": LEVEL, "ratio": ratio, "slowest": speeds[0.0], "fastest": speeds[ratio]}


def collapse(evidence: Evidence, _: float) -> dict[str, float]:
    """Median of L_trans over its prediction without damping and at the largest ratio, for both boundaries."""
    out: dict[str, float] = {}
    for boundary in ("displacement", "stress"):
        table = evidence.runs(f"damping_{boundary}")
        length = table["transition_length"] / table["paper_transition_length"]
        medians = length.groupby(table["damping_ratio"]).median()
        out[f"{boundary}_change"] = float(medians.iloc[-1] / medians.iloc[0])
    return out | {"ratio": float(medians.index[-1])}


def never_arrives(evidence: Evidence, _: float) -> dict[str, float]:
    """Gap and time of the last release, and how sure that is; exact times at fractions of the way."""
    table = evidence.runs("scaling_stress", INSIDE)
    late = ratios(table, "last_release_time", "balance_distance")
    out = {
        "gap": float((table["balance_distance"] - table["last_release_distance"]).abs().median()),
        "earliest": float(late.min()),
        "latest": float(late.max()),
    }
    for name, quantity in {"last": "last_release_time", "share": "transition_time"}.items():
        relative = ratios(table, f"uncertainty_{quantity}", quantity)
        out[f"uncertainty_of_{name}"] = float(np.nanmedian(relative))
    for choice, tables in at_ours(arrests(evidence)):
        if choice["fraction"] != LAST:
            median = float(np.nanmedian(ratios(tables[0], "time", "distance")))
            out[f"median_{100.0 * float(choice['fraction']):.0f}"] = median
    return out


def strain_term(evidence: Evidence, _: float) -> dict[str, float]:
    """Curvature of slip at the nucleation point over the pre-stress there, halfway to the transition of figure 4."""
    exact = evidence.tables["derivations"].set_index("quantity")["value"]
    if np.isnan(exact["strain_term"]):
        raise NoRuns("space_time_displacement")
    return {"share": float(exact["strain_term"])}


def literal_threshold(evidence: Evidence, _: float) -> dict[str, float]:
    """Runs that reach the slip 2 tau/gamma with tau = 1 and tau = tau_0, and when, over the first stick."""
    table = evidence.runs("scaling_displacement")
    when = (table["slip_time_background"] / table["transition_time"]).dropna()
    return {
        "runs": float(len(table)), "nucleation": float(table["slip_time_nucleation"].notna().sum()),
        "background": float(len(when)), "earliest": float(when.min()), "latest": float(when.max()),
    }  # fmt: skip


def widths(evidence: Evidence, _: float) -> dict[str, float]:
    """Width of the undamped pulse of figure 4, and the spread over the steady pulses that were run."""
    width = evidence.runs("any_prestress")["pulse_width"]
    figure = float(evidence.tables["space_time_displacement"]["paper_pulse_width"].iloc[0])
    return {"figure": figure, "narrowest": float(width.min()), "widest": float(width.max())}


def every_gamma(evidence: Evidence, _: float) -> dict[str, float]:
    """How far the exact undamped speed on the finest lattice of the sweep is from the formula, at its largest gamma."""
    rows = evidence.runs("speed_against_gamma", where=UNDAMPED).query("gamma == gamma.max()", engine="python")
    off = deviations(rows, "lattice_front_speed_right", "paper_front_speed_right")
    return {
        "gamma": float(rows["gamma"].iloc[0]), "spacing": float(rows["dx"].iloc[0]), "largest": float(off.max()),
    }  # fmt: skip


def chain_front_speed(evidence: Evidence, _: float) -> dict[str, float]:
    """How far simulated fronts on single blocks are from the exact speed of a chain with leaf springs."""
    off = deviations(
        evidence.runs("burridge_knopoff_speed"), "front_speed_right", "lattice_front_speed_right"
    )
    return {"median": float(np.median(off)), "largest": float(off.max())}


def best_fit(evidence: Evidence, _: float) -> dict[str, float | str]:
    """What the published figure was made with: best fit, confidence region, how much worse the other rule is."""
    found = inference(evidence.tables["published_figure"])
    best = found["best"]
    low, high = best["regions"][0.95]["damping_ratio"]
    return {
        "release": best["release"], "chi_square": best["chi2"], "degrees": float(best["dof"]),
        "ratio": best["damping_ratio"], "low": low, "high": high, "difference": found["difference"],
    }  # fmt: skip


def published_scheme(evidence: Evidence, _: float) -> dict[str, float]:
    """How far numbers of the authors' published scheme, and of ours on the same lattice, are from the exact ones."""
    study = evidence.tables["published_scheme"].set_index("quantity")
    names = {"front_speed": "speed", "first_stick_time": "time", "pulse_slip": "slip"}
    return {
        f"{name}_{who}": abs(float(study.loc[quantity, who] / study.loc[quantity, "exact"]) - 1.0)
        for quantity, name in names.items()
        for who in ("published", "localised")
    }


FINDINGS: dict[str, Callable[[Evidence, float], Mapping[str, float | str]]] = {
    "pulse_at_figure_damping": damped_pulse,
    "third_parameter": third_parameter,
    "collapse_against_damping": collapse,
    "front_never_arrives": never_arrives,
    "strain_term_not_small": strain_term,
    "literal_slip_threshold": literal_threshold,
    "width_of_order_H": widths,
    "speed_exact_at_every_gamma": every_gamma,
    "chain_front_speed": chain_front_speed,
    "published_figure_made_with": best_fit,
    "published_scheme": published_scheme,
    "duration_criterion": lambda *_: {"factor": float(np.pi / np.sqrt(2.0))},
}
