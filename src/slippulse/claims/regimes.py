"""Claims about what always or never happens: cracks and pulses, growth and decay, blocks and springs.

A function is named as its claim.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import chain
from typing import NamedTuple

import numpy as np
import pandas as pd

from ..data.numerals import number
from ..measure.regime import REGIMES
from . import rules
from .evidence import Claim, Evidence

TWO_WAY, STEADY = "pulses, two-way", "pulse, one-way, steady"
# A pulse a block wide has this many that slide at once.
ABOUT_ONE = 1.0
FRICTION = r"$\mu_k/(\mu_s-\mu_k)$"
CHANGE, HALF_WIDTH = "largest_velocity_change", "pulse_half_width"
# On which lattices the change of a pulse is told.
CHANGED = f"abs({CHANGE}) > uncertainty_{CHANGE}"


class Always(NamedTuple):
    """What is to hold on a lattice in which runs of some sweeps: an expression, or one of some regimes at the end.

    With regimes the exact solution decides runs that are too short, and those on which lattices disagree.

    Attributes
    ----------
    sweeps : with blanks between
    told : which runs last long enough for a lattice to tell
    counted : besides the runs judged, others whose regimes are counted, by words; None if none are
    numbers : of the whole first sweep, by words
    """

    sweeps: str
    where: str
    holds: str = ""
    told: str = ""
    counted: Mapping[str, str] | None = None
    ends: Sequence[str] = ()
    numbers: Mapping[str, str] = {}


# A run tells of the transition if it lasts 1.5 of the paper's T_trans; under a stress boundary, 2.6 |x_minus|, as the
# collapses of figure 5 are run. Pulses that formed at level 0 meet another, `beyond` (`meet`); a small perturbation is
# within 0.03, in units of the friction drop.
ALWAYS = {
    "symmetric_displacement_pulses": Always(
        "regimes_displacement", "left > 0", told="duration > 1.5 * paper_transition_time", ends=[TWO_WAY]
    ),
    "one_way_pulse_displacement": Always(
        "regimes_displacement_asymmetric", "right > 0",
        ends=[regime for regime in REGIMES if regime.startswith("pulse, one-way")],
        counted={r"at $\tau_{0,r}=0$, without a verdict": "right == 0"},
    ),
    "symmetric_stress_cracks": Always("regimes_stress", "left == right > 0", ends=["crack-like, two-way"]),
    "one_way_pulse_stress": Always(
        "regimes_stress", "left < 0 and right == 0", told="duration >= 2.6 * exact_balance_distance",
        counted={r"at $\tau_{0,r}>0$, without a verdict": "left < 0 < right"}, ends=[STEADY],
    ),
    "stress_pulse_needs_barrier": Always(
        "regimes_stress", "(left < 0) == (right < 0)",
        ends=[regime for regime in REGIMES if regime not in (TWO_WAY, STEADY, "pulse, one-way, growing")],
    ),
    "steady_for_any_prestress": Always(
        "any_prestress steady_elsewhere", "0 < left < 1",
        f"slip_variation < {{tolerance}} and regime == {TWO_WAY!r}",
    ),
    "grows_above_zero": Always("regimes_beyond", "beyond > 0", "changed == 1 and widened == 1", CHANGED, {}),
    "decays_below_zero": Always("regimes_beyond", "beyond < 0", "changed == -1 and widened == -1", CHANGED, {}),
    "small_perturbation_changes_pulse": Always(
        "regimes_beyond", "0 < abs(beyond) <= 0.03", "changed * beyond > 0 and widened * beyond > 0", CHANGED,
        numbers={"smallest level": "abs(beyond).where(beyond != 0).min()"},
    ),
    "steady_only_at_zero": Always(
        "regimes_beyond", "",
        f"(beyond == 0 and abs({CHANGE}) <= {{steady}}) or (beyond != 0 and changed != 0)",
    ),
}  # fmt: skip


def always(evidence: Evidence, id: str) -> Claim:
    """A row of `ALWAYS`."""
    row, sweeps = ALWAYS[id], ALWAYS[id].sweeps.split()
    holds = row.holds.format(tolerance=evidence.tolerance(id), steady=evidence.steady)
    holds = holds or f"regime in {[*row.ends]}"
    decided = (evidence.agreed(sweep, row.where, holds, row.told, row.ends) for sweep in sweeps)
    counted = {} if row.counted is None else {"at the end": row.where, **row.counted}
    further = {
        f"{words}: {regime}": float(count)
        for words, where in counted.items()
        for regime, count in evidence.lattices(*sweeps, where=where)[0]["regime"].value_counts().items()
    }
    for words, expression in row.numbers.items():
        further[words] = float(evidence.tables[sweeps[0]].eval(expression))
    return evidence.qualitative(chain.from_iterable(decided)) | {"further": further}


def meet(table: pd.DataFrame) -> dict[str, pd.Series]:
    """Of each run that meets another level whether its pulse grows (1), decays (-1) or neither, and so for its width.

    By more than in the run that began alike and meets level 0; one that is gone has decayed.
    """
    began = table[table["beyond"] == 0.0].set_index("left")
    change, still = table[CHANGE], table["left"].map(began[CHANGE])
    wider = table[HALF_WIDTH] - table["left"].map(began[HALF_WIDTH])
    signs = {"changed": np.sign(change).where(change.abs() > still.abs(), 0.0), "widened": np.sign(wider)}
    return {name: sign.mask(table["regime"] == "arrested", -1.0).fillna(0.0) for name, sign in signs.items()}


def shown(evidence: Evidence, held: dict[str, int], **further: float) -> Claim:
    """A claim that there are runs of each case: one of each suffices."""
    numbers = {name: float(value) for name, value in (held | further).items()}
    verdict = "reproduced" if all(held.values()) else "inconclusive"
    return evidence.qualitative([True] * sum(held.values())) | {"verdict": verdict, "further": numbers}


def no_weakening_needed(evidence: Evidence, id: str) -> Claim:
    """There are steady pulses under both boundary conditions, and friction is one constant while sliding."""
    cases = {"displacement": ("any_prestress", TWO_WAY), "stress": ("stress_pulses", STEADY)}
    held = {
        f"with the {boundary} held": evidence.agreed(name, "", f"regime == {regime!r}").count(True)
        for boundary, (name, regime) in cases.items()
    }
    return shown(evidence, held)


def only_positive_velocities(evidence: Evidence, id: str) -> Claim:
    """No run of any simulation has a negative slip velocity; what friction must be for that."""
    finest = pd.concat([evidence.tables[name] for name in evidence.swept], ignore_index=True)
    needed, smallest = float(finest["friction_ratio_needed"].max()), float(finest["min_velocity"].min())
    decided = finest["min_velocity"] >= -evidence.tolerance(id)
    back = int((finest["min_stuck_stress"] <= -1.0).sum())
    why = f"Blocks here cannot slide back; at the printed threshold, which has two sides, some would in {back} of"
    why += f" {len(finest)} runs. It needs {FRICTION} of at least {number(needed, 3)}."
    return evidence.qualitative(decided, condition=needed > 0.0) | {
        "further": {
            f"{FRICTION} needed": needed,
            "smallest velocity": smallest,
            "runs in which blocks would slide back at the printed threshold": float(back),
        },
        "why": why if all(decided) and needed > 0.0 else "",
    }


def burridge_knopoff_pulses(evidence: Evidence, id: str) -> Claim:
    """There are pulses both ways with leaf springs, and a pulse one way without; and how many blocks wide they are."""
    chain, spike = (evidence.lattices(f"burridge_knopoff_{name}")[0] for name in ("chain", "stress"))
    one_way = spike[spike["regime"].str.startswith("pulse, one-way")]["sliding_at_once"]
    two_way = chain[chain["regime"] == TWO_WAY]["sliding_at_once"]
    held = {"with leaf springs": len(two_way), "without": len(one_way)}
    fewest, most = two_way.min(), two_way.max()
    further = {"fewest blocks at once": fewest, "most": most, "without leaf springs": one_way.max()}
    claim = shown(evidence, held, **further)
    if claim["verdict"] != "reproduced" or fewest <= ABOUT_ONE:
        return claim
    why = f"The two kinds of pulse are reproduced, their width is not: {number(fewest)} to {number(most)} blocks."
    return claim | {"verdict": "reproduced with caveat", "why": why}


def dimensional_peak_velocity(evidence: Evidence, id: str) -> Claim:
    """The printed dimensional peak velocity over U/T 1/sqrt(gamma), for a layer of rock; H and the strengths cancel."""
    modulus, shear_modulus, density = 9.0e10, 3.0e10, 2700.0
    slip, time = 2.0 / modulus, np.sqrt(density / modulus)
    derived = slip / time / np.sqrt(2.0 * shear_modulus / modulus)
    ratio = float(1.0 / np.sqrt(2.0 * shear_modulus * density) / derived)
    deviation = abs(ratio - 1.0)
    return {
        "verdict": rules.within(deviation, 0.0, evidence.tolerance(id)), "predicted": 1.0, "measured": ratio,
        "uncertainty": 8.0 * float(np.finfo(float).eps), "deviation": deviation,
    }  # fmt: skip
