"""What the paper says of other friction laws, as far as friction linear in slip rate tests it."""

from __future__ import annotations

import pandas as pd

from .evidence import Claim, Evidence, NoRuns

# Distance from the exact line, relative, beyond which the regime of a lattice is decided.
DECIDED = 0.08


def rate_claims(evidence: Evidence) -> list[Claim]:
    """Pulses for many friction laws and for all, and what changes with the law."""
    runs = evidence.tables["rate_dependence"].query("role == 'lattice'")
    if runs.empty:
        raise NoRuns("rate_dependence")
    return [many_laws(evidence, runs), any_law(evidence, runs), changed(evidence, runs)]


def many_laws(evidence: Evidence, runs: pd.DataFrame) -> Claim:
    """At each pre-stress there are pulses with friction that weakens, and that strengthens, with slip rate."""
    depends = runs[runs["over_critical"] != 0.0]
    pulses = (depends["regime"] == "pulse").groupby([depends["level"], depends["over_critical"] > 0.0]).any()
    limit = runs["rate_strengthening"] / runs["over_critical"] / runs["gamma"] ** 0.5
    found = {
        f"where they end, over the square root of gamma, at the {name} pre-stress": float(value)
        for name, value in (("lowest", limit.min()), ("highest", limit.max()))
    }
    return evidence.qualitative("pulses_for_many_friction_laws", pulses, condition=True) | {"further": found}


def any_law(evidence: Evidence, runs: pd.DataFrame) -> Claim:
    """The rupture is a pulse at every rate dependence; lattices next to the exact line decide nothing."""
    inside, pulse = runs["over_critical"].abs() < 1.0, runs["regime"] == "pulse"
    near = (runs["over_critical"].abs() - 1.0).abs() < DECIDED
    decided = [None if close else held for close, held in zip(near, pulse, strict=True)]
    found = {
        "runs on the side of the exact line that it says": float((inside == pulse).sum()),
        "others, all next to the line": float((near & (inside != pulse)).sum()),
        "others, away from it": float((~near & (inside != pulse)).sum()),
    }
    return evidence.qualitative("pulses_whatever_friction", decided) | {"further": found}


def changed(evidence: Evidence, runs: pd.DataFrame) -> Claim:
    """Width and slip at the strongest dependences that still have pulses are not those without one."""
    id = "other_laws_change_pulses"
    held, further = [], {}
    for quantity in ("pulse_width", "pulse_slip"):
        of = runs.pivot(index="level", columns="over_critical", values=quantity)
        ratio = of[[-0.9, 0.9]].div(of[0.0], axis=0)
        held += list(((ratio - 1.0).abs() > evidence.tolerance(id)).to_numpy().ravel())
        further[f"smallest change of the {quantity.removeprefix('pulse_')}"] = float(
            (ratio - 1.0).abs().min().min()
        )
    return evidence.qualitative(id, held, condition=True) | {"further": further}
