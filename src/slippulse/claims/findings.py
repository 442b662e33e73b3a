"""What we found beside the claims: numbers of ours, without a verdict on the paper."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pandas as pd

from ..claims.inference import inference
from ..data.prose import fill
from ..model.scene import prestress_from
from ..theory.front_law import front_speed, front_speed_undamped, lattice_front_speed
from ..theory.pulse import paper_pulse, steady_pulse
from ..theory.rupture import Rupture
from .evidence import Evidence
from .reading import Numbers
from .transition import SHARES, share_times

# What the paper's formulas for the undamped pulse and the exact damped theory have, by measured quantity.
PULSE = {
    "speed": (
        "front_speed_right",
        lambda row: float(front_speed_undamped(row.left)),
        lambda pulse: pulse.speed,
    ),
    "peak": ("pulse_peak_velocity", lambda row: row.gamma**-0.5, lambda pulse: pulse.peak_velocity),
    "width": ("pulse_width", lambda row: paper_pulse(row.left, row.gamma).width, lambda pulse: pulse.width),
    "slip": ("pulse_slip", lambda row: 2.0 * row.left / row.gamma, lambda pulse: pulse.slip),
}


def findings(
    evidence: Evidence, damping_ratio: float, share: float, study: pd.DataFrame, texts: Mapping[str, str]
) -> list[dict]:
    """Each finding: id, its numbers by name, and its text.

    Parameters
    ----------
    damping_ratio : beta/dx of the figures
    share : share of |x_minus| at which a stress boundary's sweeps were measured
    study : of the published space-time figure, results/studies/published_figure.csv
    texts : per finding, Markdown with expressions over its numbers `n`

    Raises
    ------
    ValueError
        If the texts are not about the same findings, or ask for a number that there is not.
    """
    numbers = {
        "pulse_at_figure_damping": lambda: damped_pulse(evidence, damping_ratio),
        "third_parameter": lambda: third_parameter(evidence),
        "collapse_against_damping": lambda: collapse(evidence),
        "front_never_arrives": lambda: never_arrives(evidence, share),
        "strain_term_not_small": lambda: strain_term(evidence),
        "literal_slip_threshold": lambda: literal_threshold(evidence),
        "width_of_order_H": lambda: widths(evidence),
        "speed_exact_at_every_gamma": lambda: every_gamma(evidence),
        "published_figure_made_with": lambda: made_with(study),
        "duration_criterion": lambda: {"factor": float(np.pi / np.sqrt(2.0))},
    }
    if odd := sorted({*numbers} ^ {*texts}):
        raise ValueError(f"findings: {', '.join(odd)}; allowed: the same in the texts and in the code")
    found = {id: _or_nothing(find) for id, find in numbers.items()}
    return [
        {"id": id, "numbers": each, "text": fill(texts[id], {"n": Numbers(each)})}
        for id, each in found.items()
    ]


def _or_nothing(find: Callable[[], dict[str, float]]) -> dict[str, float]:
    """The numbers of a finding, or none where an altered configuration left no runs to take them from."""
    try:
        return find()
    except (ValueError, LookupError, StopIteration, ArithmeticError):
        return {}


def damped_pulse(evidence: Evidence, ratio: float) -> dict[str, float]:
    """Largest deviation of each undamped formula at the figures' damping, and of the exact theory with damping."""
    table = evidence.lattices("steady_displacement")[0]
    ratios = table["damping_ratio"].unique()
    nearest = float(ratios[np.argmin(np.abs(ratios - ratio))])
    rows = list(table[table["damping_ratio"] == nearest].itertuples())
    out = {"damping_ratio": nearest}
    for name, (quantity, paper, exact) in PULSE.items():
        found = np.array([getattr(row, quantity) for row in rows])
        for who, values in (("paper", map(paper, rows)), ("exact", (exact(damped(row)) for row in rows))):
            out[f"{name}_{who}"] = float(np.max(np.abs(found / np.array(list(values)) - 1.0)))
    return out


def damped(row):
    """Exact damped pulse of a row."""
    speed = float(front_speed(row.left, row.damping_ratio, row.release))
    return steady_pulse(row.left, row.gamma, row.beta, speed)


def third_parameter(evidence: Evidence) -> dict[str, float]:
    """Exact front speeds at one pre-stress, without damping and at the largest damping ratio of the collapses."""
    level = 0.6
    ratio = float(evidence.measured["damping_displacement"]["damping_ratio"].max())
    slowest, fastest = (float(front_speed(level, b)) for b in (0.0, ratio))
    return {"level": level, "ratio": ratio, "slowest": slowest, "fastest": fastest}


def collapse(evidence: Evidence) -> dict[str, float]:
    """Median of L_trans over its prediction without damping and at the largest ratio, for both boundaries."""
    out = {}
    for boundary in ("displacement", "stress"):
        table = evidence.lattices(f"damping_{boundary}")[0]
        medians = (
            (table["transition_length"] / table["paper_transition_length"])
            .groupby(table["damping_ratio"])
            .median()
        )
        out |= {
            f"{boundary}_undamped": float(medians.iloc[0]), f"{boundary}_damped": float(medians.iloc[-1]),
            f"{boundary}_change": float(medians.iloc[-1] / medians.iloc[0]),
        }  # fmt: skip
    return out | {"ratio": float(medians.index[-1])}


def never_arrives(evidence: Evidence, share: float) -> dict[str, float]:
    """Gap and time of the last release, and how they change with the lattice; exact times at shares of the way."""
    tables = evidence.lattices("scaling_stress")
    gaps = [float((t["balance_distance"] - t["last_release_distance"]).abs().median()) for t in tables]
    late = tables[0]["last_release_time"] / tables[0]["balance_distance"]
    study = {
        name: evidence.points("scaling_stress", name) for name in ("last_release_time", "transition_time")
    }
    relative = {name: float((rows["uncertainty"] / rows["value"]).median()) for name, rows in study.items()}
    times = share_times(evidence, share)
    out = {
        "gap": gaps[0], "gap_coarsest": gaps[-1], "earliest": float(late.min()), "latest": float(late.max()),
        "uncertainty_of_last": relative["last_release_time"], "uncertainty_of_share": relative["transition_time"],
    }  # fmt: skip
    for each in SHARES:
        rows = times[times["share"] == each]
        out[f"median_{100.0 * each:g}"] = float((rows["time"] / rows["distance"]).median())
    return out


def strain_term(evidence: Evidence) -> dict[str, float]:
    """Curvature of slip at the nucleation point over the pre-stress there, halfway to the transition of figure 4."""
    row = next(evidence.measured["space_time_displacement"].itertuples())
    rupture = Rupture(prestress_from(row._asdict()), row.gamma, row.damping_ratio, row.release, row.duration)
    time, step = 0.5 * rupture.transition_time, 1e-3
    strain = rupture.strain(np.array([step]), time)
    return {"share": float(abs(strain[0] / step))}


def literal_threshold(evidence: Evidence) -> dict[str, float]:
    """Runs that reach the slip 2 tau/gamma with tau = 1 and tau = tau_0, and when, over the first stick."""
    table = evidence.lattices("scaling_displacement")[0]
    shares = (table["slip_time_background"] / table["transition_time"]).dropna()
    return {
        "runs": float(len(table)), "nucleation": float(table["slip_time_nucleation"].notna().sum()),
        "background": float(len(shares)), "earliest": float(shares.min()), "latest": float(shares.max()),
    }  # fmt: skip


def widths(evidence: Evidence) -> dict[str, float]:
    """Width of the undamped pulse of figure 4, and the spread over the steady pulses that were run."""
    panel = next(evidence.measured["space_time_displacement"].itertuples())
    table = evidence.lattices("any_prestress")[0]
    return {
        "figure": paper_pulse(panel.left, panel.gamma).width, "narrowest": float(table["pulse_width"].min()),
        "widest": float(table["pulse_width"].max()),
    }  # fmt: skip


def every_gamma(evidence: Evidence) -> dict[str, float]:
    """How far the exact undamped speed on the finest lattice of the sweep is from the formula, at its largest gamma."""
    table = evidence.lattices("speed_against_gamma")[0]
    rows = table[table["gamma"] == table["gamma"].max()]
    off = [
        abs(lattice_front_speed(row.left, row.gamma, row.dx) / float(front_speed_undamped(row.left)) - 1.0)
        for row in rows.itertuples()
    ]
    return {
        "gamma": float(rows["gamma"].iloc[0]),
        "spacing": float(rows["dx"].iloc[0]),
        "largest": float(max(off)),
    }


def made_with(study: pd.DataFrame) -> dict[str, float | str]:
    """What the published figure was made with: best fit, confidence region, how much worse the other rule is."""
    found = inference(study)
    best = found["best"]
    low, high = best["regions"][0.95]["damping_ratio"]
    return {
        "release": best["release"], "chi_square": best["chi2"], "degrees": float(best["dof"]),
        "ratio": best["damping_ratio"], "low": low, "high": high, "difference": found["difference"],
    }  # fmt: skip
