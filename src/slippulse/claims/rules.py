"""From deviation and uncertainty to a verdict: one rule for each kind of claim."""

from collections.abc import Callable, Iterable, Sequence

import numpy as np

KINDS = ("exact", "approximate", "qualitative", "reading", "arithmetic")
DEPENDS = "depends on an open choice"
VERDICTS = (
    "reproduced", "reproduced with caveat", DEPENDS, "not reproduced", "inconclusive", "not testable"
)  # fmt: skip
# Of several verdicts the first of these counts; and what a reader looks for first.
WORST_FIRST = (
    "not reproduced", DEPENDS, "inconclusive", "not testable", "reproduced with caveat", "reproduced"
)  # fmt: skip
HOLDS = {"reproduced": True, "reproduced with caveat": True, "not reproduced": False}
# Tolerances at which a verdict is looked at for where it changes, and halvings of what lies between two of them.
SCANNED, BISECTED = 41, 12
# More undecided runs than this fraction leave a qualitative claim open.
UNDECIDED = 0.1
# A number with its uncertainty.
Known = tuple[float, float]
# Below this p the readings exclude every parameter, not only most.
EXCLUDED = 0.003


def within(deviation: float, uncertainty: float, tolerance: float) -> str:
    """Verdict on one number: how far it is from its prediction, how sure that is, and how far it may be."""
    if not np.isfinite([deviation, uncertainty]).all():
        return "not testable"
    if deviation - uncertainty > tolerance:
        return "not reproduced"
    if uncertainty > tolerance:
        return "inconclusive"
    return "reproduced with caveat" if deviation + uncertainty > tolerance else "reproduced"


def worst(verdicts: Iterable[str]) -> str:
    """The worst of several verdicts; "not testable" of none."""
    return min(verdicts, key=WORST_FIRST.index, default="not testable")


def worst_tested(verdicts: Iterable[str]) -> str:
    """The worst of those that have numbers."""
    return worst(verdict for verdict in verdicts if verdict != "not testable")


def exact(
    deviations: np.ndarray, uncertainties: np.ndarray, tolerance: float
) -> tuple[str, int | None]:
    """Verdict on an equation, the worst of the runs that have numbers, and of the runs with it the farthest off."""
    verdicts = [within(*pair, tolerance) for pair in zip(deviations, uncertainties, strict=True)]
    if (found := worst_tested(verdicts)) == "not testable":
        return found, None
    return found, max(
        (i for i in range(len(verdicts)) if verdicts[i] == found), key=deviations.__getitem__
    )


def approximate(
    median: Known, tolerance: float, exponent: Known | None = None, allowed: float = 0.0
) -> str:
    """Verdict on an estimate: the worse of those on its median deviation and, if one is claimed, on its exponent."""
    found = within(*median, tolerance)
    if exponent is None:
        return found
    return worst([found, within(abs(exponent[0] - 1.0), exponent[1], allowed)])


def over_choices(verdicts: Sequence[str]) -> str:
    """Verdict on a claim from those at every admissible combination of what the paper leaves open."""
    held = {HOLDS.get(verdict) for verdict in verdicts}
    return DEPENDS if {True, False} <= held else worst_tested(verdicts)


def flips(at: Callable[[float], str], tolerance: float) -> list[dict]:
    """Tolerances, from a tenth to ten times its own, at which a verdict changes, each with what is on both sides."""
    if not tolerance:
        return []
    factors = np.geomspace(0.1, 10.0, SCANNED)
    found = [at(tolerance * factor) for factor in factors]
    out = []
    for low, high, below, above in zip(factors, factors[1:], found, found[1:], strict=False):
        for _ in range(BISECTED if below != above else 0):
            middle = np.sqrt(low * high)
            low, high = (middle, high) if at(tolerance * middle) == below else (low, middle)
        if below != above:
            out.append({"tolerance": float(tolerance * high), "below": below, "above": above})
    return out


def qualitative(held: int, failed: int, undecided: int, condition: bool = False) -> str:
    """Verdict on an always, never or every; ``condition``: whether it needs one that the paper does not state."""
    if not held + failed + undecided:
        return "not testable"
    if failed:
        return "not reproduced"
    if undecided > UNDECIDED * (held + undecided):
        return "inconclusive"
    return "reproduced with caveat" if undecided or condition else "reproduced"


def reading(p: float, degrees_of_freedom: int, tolerance: float) -> str:
    """Verdict on a figure read off, by p of the best fit; degrees of freedom: readings less fitted parameters."""
    if not np.isfinite(p):
        return "not testable"
    if degrees_of_freedom < 2:
        return "inconclusive"
    if p < EXCLUDED:
        return "not reproduced"
    return "reproduced with caveat" if p < tolerance else "reproduced"
