"""Claims about which ruptures are cracks and which are pulses, and about blocks and springs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np
import pandas as pd

from ..data.numerals import number
from ..measure.regime import UNDECIDED
from . import rules
from .evidence import Claim, Evidence, Where
from .pulses import every

# A pulse about a block wide has at most this many that slide at once.
BLOCKS = 2.0
LASTING = ("pulse, one-way, steady", "pulse, one-way, growing", "pulses, two-way")
# A run tells of the transition if it lasts this many of the paper's T_trans; under a stress boundary, of |x_minus|, as
# the collapses of figure 5 are run.
HALF_PERIODS, BALANCE_DISTANCES = 1.5, 2.6
FRICTION = r"$\mu_k/(\mu_s-\mu_k)$"


class Regimes(NamedTuple):
    """In which runs of a sweep the regime is one of some; which last long enough to tell; which are only counted."""

    sweep: str
    where: Where
    holds: Callable[[pd.Series], pd.Series]
    told: Where = every
    counted: tuple[str, Where] | None = None


REGIMES = {
    "symmetric_displacement_pulses": Regimes(
        "regimes_displacement",
        lambda t: t["left"] > 0.0,
        lambda regime: regime == "pulses, two-way",
        lambda t: t["duration"] > HALF_PERIODS * t["paper_transition_time"],
    ),
    "one_way_pulse_displacement": Regimes(
        "regimes_displacement_asymmetric",
        lambda t: t["right"] > 0.0,
        lambda regime: regime.str.startswith("pulse, one-way"),
        counted=(r"at $\tau_{0,r}=0$", lambda t: t["right"] == 0.0),
    ),
    "symmetric_stress_cracks": Regimes(
        "regimes_stress",
        lambda t: (t["left"] == t["right"]) & (t["left"] > 0.0),
        lambda regime: regime == "crack-like, two-way",
    ),
    "one_way_pulse_stress": Regimes(
        "regimes_stress",
        lambda t: (t["left"] < 0.0) & (t["right"] == 0.0),
        lambda regime: regime == "pulse, one-way, steady",
        lambda t: t["duration"] >= BALANCE_DISTANCES * t["exact_balance_distance"],
        counted=(r"at $\tau_{0,r}>0$", lambda t: (t["left"] < 0.0) & (t["right"] > 0.0)),
    ),
    "stress_pulse_needs_barrier": Regimes(
        "regimes_stress",
        lambda t: (t["left"] < 0.0) == (t["right"] < 0.0),
        lambda regime: ~regime.isin(LASTING),
    ),
}


def regime_claims(evidence: Evidence) -> list[Claim]:
    """Symmetric and asymmetric pre-stress, barriers, blocks and springs, and velocities that are never negative."""
    found = [in_the_end(evidence, id, *row) for id, row in REGIMES.items()]
    return [
        *found,
        no_weakening(evidence),
        positive(evidence),
        burridge_knopoff(evidence),
        peak_velocity(evidence),
    ]


def in_the_end(evidence: Evidence, id: str, sweep: str, where, holds, told, counted) -> Claim:
    """Runs that are too short, and those on which lattices disagree, are decided by the regime that they end in."""
    decided = evidence.agreed(
        sweep,
        where,
        lambda t: holds(t["regime"]),
        lambda t: holds(t["exact_regime"]).where(t["exact_regime"] != UNDECIDED, None),
        told,
    )
    claim = evidence.qualitative(id, decided)
    if counted is None:
        return claim
    position, which = counted
    table = evidence.lattices(sweep)[0]
    regimes = table[which(table)]["regime"].value_counts()
    further = {f"{position}, without a verdict: {regime}": float(count) for regime, count in regimes.items()}
    return replace(claim, further=further)


def no_weakening(evidence: Evidence) -> Claim:
    """There are steady pulses under both boundary conditions, and friction is one constant while sliding."""
    cases = {
        "with the displacement held": ("any_prestress", "pulses, two-way"),
        "with the stress held": ("stress_pulses", "pulse, one-way, steady"),
    }
    held = {}
    for case, (name, regime) in cases.items():
        held[case] = sum(map(bool, evidence.agreed(name, every, lambda t: t["regime"] == regime)))  # noqa: B023
    return _shown(evidence, "no_weakening_needed", held)


def _shown(evidence: Evidence, id: str, held: dict[str, int], **further: float) -> Claim:
    """A claim that there are runs of each case."""
    claim = evidence.qualitative(id, [True] * sum(held.values()))
    numbers = {name: float(value) for name, value in (held | further).items()}
    return replace(claim, verdict=rules.existence([*held.values()]), further=numbers)


def positive(evidence: Evidence) -> Claim:
    """No run of any simulation has a negative slip velocity; what friction must be for that."""
    id = "only_positive_velocities"
    names = [name.removeprefix("coarser/") for name in evidence.tables if name.startswith("coarser/")]
    finest = pd.concat([evidence.tables[name] for name in names], ignore_index=True)
    needed = float(finest["friction_ratio_needed"].max())
    decided = list(finest["min_velocity"] >= -evidence.tolerance(id))
    claim = evidence.qualitative(id, decided, condition=needed > 0.0)
    why = f"It needs {FRICTION} of at least {number(needed, 3)}." if all(decided) and needed > 0.0 else ""
    further = {f"{FRICTION} needed": needed, "smallest velocity": float(finest["min_velocity"].min())}
    return replace(claim, further=further, why=why)


def burridge_knopoff(evidence: Evidence) -> Claim:
    """There are pulses of one or two blocks both ways with leaf springs, and a pulse one way without."""
    chain, spike = (evidence.lattices(f"burridge_knopoff_{name}")[0] for name in ("chain", "stress"))
    two_way = chain[chain["regime"] == "pulses, two-way"]["sliding_at_once"]
    held = {
        "with leaf springs": int((two_way <= BLOCKS).sum()),
        "without": int(spike["regime"].str.startswith("pulse, one-way").sum()),
    }
    further = {
        "chains that make two pulses": len(two_way),
        "fewest blocks at once": two_way.min(),
        "most": two_way.max(),
    }
    return _shown(evidence, "burridge_knopoff_pulses", held, **further)


def peak_velocity(evidence: Evidence) -> Claim:
    """The printed dimensional peak velocity over U/T 1/sqrt(gamma), for a layer of rock; H and the strengths cancel."""
    modulus, shear_modulus, density = 9.0e10, 3.0e10, 2700.0
    slip, time = 2.0 / modulus, np.sqrt(density / modulus)
    derived = slip / time / np.sqrt(2.0 * shear_modulus / modulus)
    ratio = float(1.0 / np.sqrt(2.0 * shear_modulus * density) / derived)
    id, deviation = "dimensional_peak_velocity", abs(ratio - 1.0)
    verdict = rules.arithmetic(deviation, evidence.tolerance(id))
    return Claim(id, verdict, 1.0, ratio, 8.0 * float(np.finfo(float).eps), deviation)
