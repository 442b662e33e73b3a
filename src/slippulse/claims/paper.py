"""The whole ledger: every claim with its text, and what we found beside, in the order of manuscript/claims.yaml."""

import json
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from functools import partial
from types import SimpleNamespace

import numpy as np

from ..data.numerals import number, rounded
from ..data.prose import fill
from . import pulses, rules, transition
from .evidence import ESTIMATE, Claim, Evidence, NoRuns, evaluated
from .inference import inference, right_panel
from .reading import positions, why_text

# The claims about the two panels of the published figure.
LEFT, RIGHT = "published_space_time_figure", "published_space_time_figure_right"
# Fitted parameters of the left panel of the published figure.
FITTED = {"tau0": r"$\tau_0$", "gamma": r"$\gamma$", "damping_ratio": r"$\beta/\Delta x$"}
# Whose measured numbers, grid studies and coarser tables the claims are computed from.
SIMULATIONS = [
    "any_prestress", "arrest_profiles", "burridge_knopoff_chain", "burridge_knopoff_speed",
    "burridge_knopoff_stress", "damping_displacement", "damping_stress", "front_speed_undamped",
    "nucleation_widths", "pulses_across_a_step", "pulses_across_wide_steps", "pulses_perturbed_elsewhere",
    "regimes_beyond", "regimes_displacement", "regimes_displacement_asymmetric", "regimes_stress",
    "scaling_displacement", "scaling_stress", "space_time_displacement", "space_time_stress",
    "speed_against_gamma", "steady_displacement", "steady_elsewhere", "stress_pulses", "undamped_pulses",
]  # fmt: skip
# What theory says of these and of front speeds at one level is compared, by topic.
PREDICTED = {
    "any_prestress": ["pulse"], "burridge_knopoff_speed": ["front"], "front_speed": ["front"],
    "front_speed_undamped": ["front"], "regimes_displacement": ["final_regime"],
    "regimes_displacement_asymmetric": ["final_regime"], "regimes_stress": ["final_regime", "transition"],
    "scaling_displacement": ["transition"], "scaling_stress": ["transition"], "space_time_displacement": ["pulse"],
    "speed_against_gamma": ["front"], "steady_displacement": ["front", "pulse"], "stress_pulses": ["transition"],
    "undamped_pulses": ["pulse"],
}  # fmt: skip


def all_claims(evidence: Evidence, readings: Mapping, sentences: Sequence[Mapping]) -> list[dict]:
    """The ledger as in claims.json, by readings of the figure; a ValueError names claims of texts or code alone."""
    evidence.assign("regimes_beyond", pulses.meet)
    # Claims that are rows of a table; any other is judged by the function of its name.
    judges = dict.fromkeys(pulses.EQUATIONS, pulses.equation) | dict.fromkeys(
        pulses.ALWAYS, pulses.always
    )
    for module in (pulses, transition):
        judges |= {id: getattr(module, id) for id in evidence.entries if hasattr(module, id)}
    found = {id: judge(evidence, id) for id, judge in judges.items()} | published_figure(
        evidence, readings
    )
    if odd := sorted({*evidence.entries} ^ {*found}):
        raise ValueError(
            f"claims: {', '.join(odd)}; allowed: the same in the texts and in the code"
        )
    where = positions(evidence.entries, sentences)
    return [written(id, found[id], entry, where[id]) for id, entry in evidence.entries.items()]


def published_figure(evidence: Evidence, readings: Mapping) -> dict[str, Claim]:
    """A claim a panel of the published space-time figure: the left one at the best fit of its readings."""
    study = evidence.tables["published_figure"]
    left = inference(study, part="arrows")["best"]
    arrows = {name: entry["statement"] for name, entry in readings.items() if entry.get("arrow")}
    further, why = {}, []
    for fit, found in {"with": left, "without": inference(study)["best"]}.items():
        further[f"chi-square {fit} the arrows"] = found["chi2"]
        for name, text in arrows.items():
            further[f"pull of the {text} at the fit {fit} the arrows"] = found["pulls"][name]
        pulls = " and ".join(number(found["pulls"][name], 2) for name in arrows)
        why.append(
            f"{fit} its arrows p is {number(found['p_value'], 2)} and they are off by {pulls}"
        )
    fit = ", ".join(f"{tex} = {rounded(left[name], 3)}" for name, tex in FITTED.items())
    panels = (
        (LEFT, "space_time_displacement", left, "all readings of the panel, its arrows among them, at their best fit, "
         f"{fit}, release rule `{left['release']}`", f"Fitted {'; '.join(why)} reading errors." if arrows else ""),
        (RIGHT, "space_time_stress", right_panel(study), "its one reading, the pre-stress being read off",
         "One reading is left when its pre-stress is read off."),
    )  # fmt: skip
    claims: dict[str, Claim] = {}
    for id, sweep, found, of, reason in panels:
        p, degrees, run = found["p_value"], found["dof"], evidence.lattices(sweep)[0].iloc[0]
        of_panel = [entry for entry in readings.values() if entry["simulation"] == sweep]
        claims[id] = {
            "verdict": rules.reading(p, degrees, evidence.tolerance(id)), "predicted": float(degrees),
            "measured": found["chi2"], "deviation": p, "why": reason, "at": partial(rules.reading, p, degrees),
            "further": {entry["statement"]: float(run[entry["quantity"]]) for entry in of_panel},
            "note": f"chi-square of {of}; then the readings in our own figure",
        }  # fmt: skip
    claims[LEFT]["further"] |= further
    return claims


def written(id: str, claim: Claim, entry: Mapping, where: str) -> dict:
    """One claim with its text, as JSON has it."""
    out = {
        "figure": "", "follows_from": [], "note": "", "source": "", "further": {}, "why": "", "caveat": "",
        "choices": [], "choice": "", "combinations": 0, "holds_at": 0, "flips_at": [],
        **dict.fromkeys(("predicted", "measured", "uncertainty", "deviation")), **entry,
        **dict.fromkeys(ESTIMATE if entry["kind"] == "approximate" else ()), "id": id, **claim,
        "figure_or_section": where, "counted": "follows_from" not in entry,
    }  # fmt: skip
    if at := out.pop("at", None):
        out["flips_at"] = rules.flips(at, out["tolerance"])
    del out["sentences"]
    out = finite(out)
    return out | {"why": why_text(SimpleNamespace(**out))}


def finite(value):
    """Builtins with None for every number that JSON does not have."""
    text = json.dumps(value, default=lambda number: number.item())
    return json.loads(text, parse_constant=lambda _: None)


def findings(
    evidence: Evidence, damping_ratio: float, entries: Mapping[str, Mapping]
) -> list[dict]:
    """Each finding: id, its numbers by name (none where an altered configuration left no runs), text and tables."""
    out = []
    for id, entry in entries.items():
        rows = entry.get("numbers", [])
        found: dict = {}
        with suppress(NoRuns):
            parts = [numbers(evidence, damping_ratio, **row) for row in rows]
            parts += [COMPUTED[id](evidence)] if id in COMPUTED else []
            found = {name: value for part in parts for name, value in part.items()}
        text = fill(entry["text"], {"n": SimpleNamespace(**found) if found else None})
        source = ", ".join([*(row["table"] for row in rows), *entry.get("source", [])])
        out.append({"id": id, "numbers": found, "text": text, "source": source})
    return out


def numbers(
    evidence: Evidence, ratio: float, table: str, take: Mapping, where: str = ""
) -> dict[str, float]:
    """Expressions over columns of the chosen rows of one table; `NoRuns` without rows."""
    rows = evidence.lattices(table)[0] if table in evidence.swept else evidence.tables[table]
    rows = rows.assign(figures=ratio)
    if (rows := rows[evaluated(rows, where)]).empty:
        raise NoRuns(table)
    return {
        name: float(rows.eval(expression, engine="python")) for name, expression in take.items()
    }


def collapse(evidence: Evidence) -> dict[str, float]:
    """Median change of L_trans between no damping and the largest ratio, over the scenes that have it at both."""
    out: dict[str, float] = {}
    for boundary in ("displacement", "stress"):
        table = evidence.lattices(f"damping_{boundary}")[0].fillna({"gamma": 0.0})
        lengths = table.set_index(["left", "width", "gamma", "damping_ratio"])[
            "transition_length"
        ].unstack()
        if lengths.empty:
            raise NoRuns(boundary)
        change = lengths.iloc[:, -1] / lengths.iloc[:, 0]
        numbers = {"change": change.median(), "runs": change.count(), "scenes": len(change)}
        out |= {f"{boundary}_{name}": float(number) for name, number in numbers.items()}
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
    # Median ratio of the exact time at each fraction of the way to the predicted one.
    "front_never_arrives": lambda evidence: {
        f"median_{100.0 * fraction:.0f}": ratio
        for fraction, ratio in transition.medians(evidence, "time", "distance").items()
    },
    "published_figure_made_with": best_fit,
    "duration_criterion": lambda _: {"factor": float(np.pi / np.sqrt(2.0))},
}
