"""Claims about which ruptures are cracks and which are pulses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pandas as pd

from ..data.numerals import number
from ..model.balance import prestress_balance_position
from ..model.scene import prestress_from
from ..predict.final_regime import UNDECIDED, final_regime
from . import rules
from .evidence import Evidence
from .ledger import Claim

# A pulse about a block wide has at most so many that slide at once.
BLOCKS = 2.0
LASTING = ("pulse, one-way, steady", "pulse, one-way, growing", "pulses, two-way")
# A run tells of the transition if it lasts so many of the paper's T_trans.
HALF_PERIODS = 1.5
# Under a stress boundary, in units of |x_minus|, as the collapses of figure 5 are run.
BALANCE_DISTANCES = 2.6
EXACT = "predict.final_regime"


def regime_claims(evidence: Evidence) -> list[Claim]:
    """Symmetric and asymmetric pre-stress, barriers, blocks and springs, and velocities that are never negative."""
    return [
        symmetric_displacement(evidence), one_way_displacement(evidence), symmetric_stress(evidence),
        one_way_stress(evidence), needs_barrier(evidence), no_weakening(evidence), positive(evidence),
        burridge_knopoff(evidence),
    ]  # fmt: skip


def in_the_end(still: float, holds: Callable[[str], bool]) -> Callable[[tuple], bool | None]:
    """Of a row whether something holds of the regime that its rupture ends in; None where theory does not say."""

    def exactly(row) -> bool | None:
        gamma = row.gamma if row.boundary == "displacement" else 0.0
        regime = final_regime(row.left, row.right, gamma, row.damping_ratio, row.release, still)
        return None if regime == UNDECIDED else holds(regime)

    return exactly


def symmetric_displacement(evidence: Evidence) -> Claim:
    """Two pulses."""
    decided = evidence.agreed(
        "regimes_displacement",
        lambda t: t["left"] > 0.0,
        lambda t: t["regime"] == "pulses, two-way",
        in_the_end(evidence.still, lambda regime: regime == "pulses, two-way"),
        lambda t: t["duration"] > HALF_PERIODS * np.pi / np.sqrt(t["gamma"]),
    )
    return evidence.qualitative(
        "symmetric_displacement_pulses", f"regimes_displacement: regime; {EXACT}", decided,
        "runs that end before one and a half of the predicted transition are decided by the exact solution",
    )  # fmt: skip


def one_way_displacement(evidence: Evidence) -> Claim:
    """One pulse, in the positive direction."""
    decided = evidence.agreed(
        "regimes_displacement_asymmetric",
        lambda t: t["right"] > 0.0,
        lambda t: t["regime"].str.startswith("pulse, one-way"),
        in_the_end(evidence.still, lambda regime: regime.startswith("pulse, one-way")),
    )
    claim = evidence.qualitative(
        "one_way_pulse_displacement", f"regimes_displacement_asymmetric: regime; {EXACT}", decided,
        r"runs with $\tau_{0,r}>0$",
    )  # fmt: skip
    table = evidence.lattices("regimes_displacement_asymmetric")[0]
    return replace(
        claim, further=counted(table[table["right"] == 0.0], r"at $\tau_{0,r}=0$, without a verdict")
    )


def counted(table: pd.DataFrame, where: str) -> dict[str, float]:
    """How many runs there are of each regime."""
    return {f"{where}: {regime}": float(count) for regime, count in table["regime"].value_counts().items()}


def symmetric_stress(evidence: Evidence) -> Claim:
    """A crack."""
    decided = evidence.agreed(
        "regimes_stress",
        lambda t: (t["left"] == t["right"]) & (t["left"] > 0.0),
        lambda t: t["regime"] == "crack-like, two-way",
        in_the_end(evidence.still, lambda regime: regime == "crack-like, two-way"),
    )
    return evidence.qualitative("symmetric_stress_cracks", f"regimes_stress: regime; {EXACT}", decided)


def one_way_stress(evidence: Evidence) -> Claim:
    """One steady pulse to the right."""

    def long_enough(table: pd.DataFrame) -> pd.Series:
        balanced = (table["left"] < 0.0) & (table["right"] == 0.0)
        reach = [
            -prestress_balance_position(prestress_from(row._asdict())) if chosen else np.nan
            for row, chosen in zip(table.itertuples(), balanced, strict=True)
        ]
        return table["duration"] >= BALANCE_DISTANCES * pd.Series(reach, index=table.index)

    decided = evidence.agreed(
        "regimes_stress",
        lambda t: (t["left"] < 0.0) & (t["right"] == 0.0),
        lambda t: t["regime"] == "pulse, one-way, steady",
        in_the_end(evidence.still, lambda regime: regime == "pulse, one-way, steady"),
        long_enough,
    )
    claim = evidence.qualitative(
        "one_way_pulse_stress", f"regimes_stress: regime; {EXACT}", decided,
        "runs that end before the left front has had its time, and those on which lattices disagree, are decided by"
        " the exact solution",
    )  # fmt: skip
    table = evidence.lattices("regimes_stress")[0]
    ahead = table[(table["left"] < 0.0) & (table["right"] > 0.0)]
    return replace(claim, further=counted(ahead, r"at $\tau_{0,r}>0$, without a verdict"))


def needs_barrier(evidence: Evidence) -> Claim:
    """Without negative pre-stress on one side alone no pulse lasts."""
    decided = evidence.agreed(
        "regimes_stress",
        lambda t: (t["left"] < 0.0) == (t["right"] < 0.0),
        lambda t: ~t["regime"].isin(LASTING),
        in_the_end(evidence.still, lambda regime: regime not in LASTING),
    )
    return evidence.qualitative(
        "stress_pulse_needs_barrier", f"regimes_stress: regime; {EXACT}", decided,
        "runs with both levels at least 0, or both below, that show no pulse that grows or keeps its size",
    )  # fmt: skip


def no_weakening(evidence: Evidence) -> Claim:
    """There are steady pulses under both boundary conditions, and friction is one constant while sliding."""
    cases: list[tuple[str, Callable]] = [
        ("any_prestress", lambda t: t["regime"] == "pulses, two-way"),
        ("stress_pulses", lambda t: t["regime"] == "pulse, one-way, steady"),
    ]
    held = [
        sum(bool(found) for found in evidence.agreed(name, lambda t: t["left"].notna(), holds))
        for name, holds in cases
    ]
    claim = evidence.qualitative(
        "no_weakening_needed", "any_prestress, stress_pulses: regime", [True] * sum(held),
        "runs with steady pulses; the friction of every sliding block is one constant, and so is normal stress",
    )  # fmt: skip
    named = {"with the displacement held": held[0], "with the stress held": held[1]}
    return replace(claim, verdict=rules.existence(held), further={k: float(v) for k, v in named.items()})


def positive(evidence: Evidence) -> Claim:
    """No run of any simulation has a negative slip velocity; what friction must be for that."""
    names = list(evidence.measured)
    finest = pd.concat([evidence.measured[name] for name in names], ignore_index=True)
    needed = float(finest["friction_ratio_needed"].max())
    smallest = finest["min_velocity"].to_numpy(float)
    claim = evidence.qualitative(
        "only_positive_velocities", "every simulation here: min_velocity, friction_ratio_needed",
        list(smallest >= -evidence.tolerance("only_positive_velocities")),
        r"condition: $\mu_k/(\mu_s-\mu_k)$ of at least the number shown, or blocks beside the pulses slide back",
        condition=needed > 0.0,
    )  # fmt: skip
    ratio = r"$\mu_k/(\mu_s-\mu_k)$"
    why = "" if claim.failed or not needed > 0.0 else f"It needs {ratio} of at least {number(needed, 3)}."
    return replace(
        claim, further={f"{ratio} needed": needed, "smallest velocity": float(smallest.min())}, why=why
    )


def burridge_knopoff(evidence: Evidence) -> Claim:
    """There are pulses of one or two blocks both ways with leaf springs, and a pulse one way without."""
    chain, spike = (evidence.lattices(f"burridge_knopoff_{name}")[0] for name in ("chain", "stress"))
    two_way = chain[chain["regime"] == "pulses, two-way"]
    held = [
        int((two_way["sliding_at_once"] <= BLOCKS).sum()),
        int(spike["regime"].str.startswith("pulse, one-way").sum()),
    ]
    claim = evidence.qualitative(
        "burridge_knopoff_pulses", "burridge_knopoff_chain, burridge_knopoff_stress: regime, sliding_at_once",
        [True] * sum(held),
        "a sketch, so that runs that do it suffice: with leaf springs two pulses in which at most two blocks slide at"
        " once, without them one pulse",
    )  # fmt: skip
    further = {
        "with leaf springs": held[0], "without": held[1], "chains that make two pulses": len(two_way),
        "fewest blocks at once": two_way["sliding_at_once"].min(), "most": two_way["sliding_at_once"].max(),
    }  # fmt: skip
    return replace(
        claim, verdict=rules.existence(held), further={name: float(value) for name, value in further.items()}
    )
