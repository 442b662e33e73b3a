"""Claims about which ruptures are cracks and which are pulses, and about blocks and springs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pandas as pd

from ..data.numerals import number
from ..measure.regime import REGIMES, UNDECIDED
from . import rules
from .evidence import Claim, Evidence

TWO_WAY, STEADY = "pulses, two-way", "pulse, one-way, steady"
# A pulse a block wide has this many that slide at once.
ABOUT_ONE = 1.0
FRICTION = r"$\mu_k/(\mu_s-\mu_k)$"


class Regimes(NamedTuple):
    """In which runs of a sweep the regime is one of some; which last long enough to tell; which are only counted."""

    sweep: str
    where: str
    allowed: list[str]
    told: str = ""
    counted: str = ""
    position: str = ""


# A run tells of the transition if it lasts 1.5 of the paper's T_trans; under a stress boundary, 2.6 |x_minus|, as the
# collapses of figure 5 are run.
ENDS = {
    "symmetric_displacement_pulses": Regimes(
        "regimes_displacement", "left > 0", [TWO_WAY], "duration > 1.5 * paper_transition_time"
    ),
    "one_way_pulse_displacement": Regimes(
        "regimes_displacement_asymmetric",
        "right > 0",
        [regime for regime in REGIMES if regime.startswith("pulse, one-way")],
        counted="right == 0",
        position=r"at $\tau_{0,r}=0$",
    ),
    "symmetric_stress_cracks": Regimes("regimes_stress", "left == right > 0", ["crack-like, two-way"]),
    "one_way_pulse_stress": Regimes(
        "regimes_stress",
        "left < 0 and right == 0",
        [STEADY],
        "duration >= 2.6 * exact_balance_distance",
        counted="left < 0 < right",
        position=r"at $\tau_{0,r}>0$",
    ),
    "stress_pulse_needs_barrier": Regimes(
        "regimes_stress",
        "(left < 0) == (right < 0)",
        [regime for regime in REGIMES if regime not in (TWO_WAY, STEADY, "pulse, one-way, growing")],
    ),
}


def regime_claims(evidence: Evidence) -> list[Claim]:
    """Symmetric and asymmetric pre-stress, barriers, blocks and springs, and velocities that are never negative."""
    others = (no_weakening, positive, burridge_knopoff, peak_velocity)
    return [
        *(in_the_end(evidence, id, row) for id, row in ENDS.items()),
        *(judge(evidence) for judge in others),
    ]


def in_the_end(evidence: Evidence, id: str, row: Regimes) -> Claim:
    """Runs that are too short, and those on which lattices disagree, are decided by the regime that they end in."""

    def exactly(table: pd.DataFrame) -> pd.Series:
        exact = table["exact_regime"]
        return exact.isin(row.allowed).where(exact != UNDECIDED, None)

    claim = evidence.qualitative(
        id, evidence.agreed(row.sweep, row.where, f"regime in {row.allowed}", row.told, exactly)
    )
    if not row.counted:
        return claim
    further = {
        f"{words}: {regime}": float(count)
        for words, where in (("at the end", row.where), (f"{row.position}, without a verdict", row.counted))
        for regime, count in evidence.lattices(row.sweep, where=where)[0]["regime"].value_counts().items()
    }
    return claim | {"further": further}


def shown(evidence: Evidence, id: str, held: dict[str, int], **further: float) -> Claim:
    """A claim that there are runs of each case: one of each suffices."""
    claim = evidence.qualitative(id, [True] * sum(held.values()))
    numbers = {name: float(value) for name, value in (held | further).items()}
    return claim | {"verdict": "reproduced" if all(held.values()) else "inconclusive", "further": numbers}


def no_weakening(evidence: Evidence) -> Claim:
    """There are steady pulses under both boundary conditions, and friction is one constant while sliding."""
    cases = {"displacement": ("any_prestress", TWO_WAY), "stress": ("stress_pulses", STEADY)}
    held = {
        f"with the {boundary} held": sum(map(bool, evidence.agreed(name, "", f"regime == {regime!r}")))
        for boundary, (name, regime) in cases.items()
    }
    return shown(evidence, "no_weakening_needed", held)


def positive(evidence: Evidence) -> Claim:
    """No run of any simulation has a negative slip velocity; what friction must be for that."""
    id = "only_positive_velocities"
    finest = pd.concat([evidence.tables[name] for name in evidence.swept], ignore_index=True)
    needed, smallest = float(finest["friction_ratio_needed"].max()), float(finest["min_velocity"].min())
    decided = finest["min_velocity"] >= -evidence.tolerance(id)
    back = int((finest["min_stuck_stress"] <= -1.0).sum())
    why = f"Blocks here cannot slide back; at the printed threshold, which has two sides, some would in {back} of"
    why += f" {len(finest)} runs. It needs {FRICTION} of at least {number(needed, 3)}."
    return evidence.qualitative(id, decided, condition=needed > 0.0) | {
        "further": {
            f"{FRICTION} needed": needed,
            "smallest velocity": smallest,
            "runs in which blocks would slide back at the printed threshold": float(back),
        },
        "why": why if all(decided) and needed > 0.0 else "",
    }


def burridge_knopoff(evidence: Evidence) -> Claim:
    """There are pulses both ways with leaf springs, and a pulse one way without; and how many blocks wide they are."""
    chain, spike = (evidence.lattices(f"burridge_knopoff_{name}")[0] for name in ("chain", "stress"))
    one_way = spike[spike["regime"].str.startswith("pulse, one-way")]["sliding_at_once"]
    two_way = chain[chain["regime"] == TWO_WAY]["sliding_at_once"]
    held = {"with leaf springs": len(two_way), "without": len(one_way)}
    fewest, most = two_way.min(), two_way.max()
    further = {"fewest blocks at once": fewest, "most": most, "without leaf springs": one_way.max()}
    claim = shown(evidence, "burridge_knopoff_pulses", held, **further)
    if claim["verdict"] != "reproduced" or fewest <= ABOUT_ONE:
        return claim
    why = f"The two kinds of pulse are reproduced, their width is not: {number(fewest)} to {number(most)} blocks."
    return claim | {"verdict": "reproduced with caveat", "why": why}


def peak_velocity(evidence: Evidence) -> Claim:
    """The printed dimensional peak velocity over U/T 1/sqrt(gamma), for a layer of rock; H and the strengths cancel."""
    modulus, shear_modulus, density = 9.0e10, 3.0e10, 2700.0
    slip, time = 2.0 / modulus, np.sqrt(density / modulus)
    derived = slip / time / np.sqrt(2.0 * shear_modulus / modulus)
    ratio = float(1.0 / np.sqrt(2.0 * shear_modulus * density) / derived)
    id, deviation = "dimensional_peak_velocity", abs(ratio - 1.0)
    return {
        "id": id, "verdict": rules.arithmetic(deviation, evidence.tolerance(id)), "predicted": 1.0,
        "measured": ratio, "uncertainty": 8.0 * float(np.finfo(float).eps), "deviation": deviation,
    }  # fmt: skip
