"""Rules that turn deviation and uncertainty into a verdict: one for each kind of claim."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

REPRODUCED = "reproduced"
CAVEAT = "reproduced with caveat"
DEPENDS = "depends on an open choice"
UNMET = "premise not met"
BEYOND = "different beyond the paper"
FAILED = "not reproduced"
INCONCLUSIVE = "inconclusive"
NOT_TESTABLE = "not testable"
VERDICTS = (REPRODUCED, CAVEAT, DEPENDS, UNMET, FAILED, BEYOND, INCONCLUSIVE, NOT_TESTABLE)
# The first of these decides among several verdicts; readers look for it first, too.
WORST_FIRST = (FAILED, UNMET, DEPENDS, INCONCLUSIVE, NOT_TESTABLE, BEYOND, CAVEAT, REPRODUCED)
HOLDS = {REPRODUCED: True, CAVEAT: True, FAILED: False, UNMET: False, BEYOND: False}
# The number of tolerances at which a verdict is computed, and of halvings where it changes.
SCANNED, BISECTED = 41, 12
# A qualitative claim stays open if a larger fraction of its runs is undecided.
MOST_UNDECIDED = 0.1
# A number with its uncertainty.
Uncertain = tuple[float, float]


def within(deviation: float, uncertainty: float, tolerance: float) -> str:
    """Verdict on one number by its deviation from the prediction and by its uncertainty."""
    if not np.isfinite([deviation, uncertainty]).all():
        return NOT_TESTABLE
    if deviation - uncertainty > tolerance:
        return FAILED
    if uncertainty > tolerance:
        return INCONCLUSIVE
    return CAVEAT if deviation + uncertainty > tolerance else REPRODUCED


def worst(verdicts: Iterable[str]) -> str:
    """The worst of several verdicts; "not testable" of none."""
    return min(verdicts, key=WORST_FIRST.index, default=NOT_TESTABLE)


def worst_tested(verdicts: Iterable[str]) -> str:
    """The worst of those that have numbers."""
    return worst(verdict for verdict in verdicts if verdict != NOT_TESTABLE)


def equation(
    deviations: np.ndarray, uncertainties: np.ndarray, tolerance: float
) -> tuple[str, int | None]:
    """Verdict on an equation, and the run that decides: of those with it, the one farthest off.

    Runs without numbers do not count; the run is None if none has numbers.
    """
    verdicts = [within(*pair, tolerance) for pair in zip(deviations, uncertainties, strict=True)]
    verdict = worst_tested(verdicts)
    deciding = [run for run, one in enumerate(verdicts) if one == verdict != NOT_TESTABLE]
    return verdict, max(deciding, key=deviations.__getitem__, default=None)


def verdict_over_choices(verdicts: Sequence[str]) -> str:
    """Verdict on a claim from those at every admissible combination of open choices."""
    held = {HOLDS.get(verdict) for verdict in verdicts}
    return DEPENDS if {True, False} <= held else worst_tested(verdicts)


def flips(verdict_at: Callable[[float], str], tolerance: float) -> list[dict]:
    """Tolerances, from a tenth to ten times, at which the verdict changes, and both verdicts."""
    if not tolerance:
        return []
    factors = np.geomspace(0.1, 10.0, SCANNED)
    verdicts = [verdict_at(tolerance * factor) for factor in factors]
    out = []
    for low, high, below, above in zip(factors, factors[1:], verdicts, verdicts[1:], strict=False):
        if below == above:
            continue
        for _ in range(BISECTED):
            middle = np.sqrt(low * high)
            if verdict_at(tolerance * middle) == below:
                low = middle
            else:
                high = middle
        out.append({"tolerance": float(tolerance * high), "below": below, "above": above})
    return out


def qualitative(held: int, failed: int, undecided: int, condition: bool = False) -> str:
    """Verdict on an always, never or every; ``condition`` is one that the paper does not state."""
    if not held + failed + undecided:
        return NOT_TESTABLE
    if failed:
        return FAILED
    if undecided > MOST_UNDECIDED * (held + undecided):
        return INCONCLUSIVE
    return CAVEAT if undecided or condition else REPRODUCED


def reading(p: float, degrees_of_freedom: int, tolerance: float) -> str:
    """Verdict on a figure read off, by p of the best fit, which may not be below the tolerance.

    The degrees of freedom are the readings less the fitted parameters.
    """
    if not np.isfinite(p):
        return NOT_TESTABLE
    if degrees_of_freedom < 2:
        return INCONCLUSIVE
    return REPRODUCED if p >= tolerance else FAILED
