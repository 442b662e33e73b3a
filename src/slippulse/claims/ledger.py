"""One claim, and the rule that turns prediction, measurement and uncertainty into a verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field

VERDICTS = ("reproduced", "reproduced with caveat", "not reproduced", "not testable")


@dataclass(frozen=True)
class Claim:
    """One entry of the ledger.

    Attributes
    ----------
    id : short name
    figure_or_section : where the paper says it
    statement : what it says, in our words; Markdown with TeX, as note and the keys of further
    predicted, measured : numbers; for a yes-or-no claim the share of tested points, 1 predicted
    uncertainty : numerical uncertainty of `measured`, from a grid study or the arithmetic
    tolerance : largest |measured - predicted| / |predicted| that counts as reproduced, fixed in the configuration
    verdict : one of VERDICTS, by `judge`
    note : what `predicted` and `measured` are, and what else there is to know
    source : the data, function or derivation behind it
    runs : how many runs it was judged by
    left_out : runs without a grid study, which were not
    median, largest : of the relative deviations of these runs from the prediction
    exact_median, exact_largest : of their relative deviations from the exact theory
    further : other numbers, by what they are
    figure : name of the figure that shows it
    """

    id: str
    figure_or_section: str
    statement: str
    predicted: float
    measured: float
    uncertainty: float
    tolerance: float
    verdict: str
    note: str
    source: str
    runs: int | None = None
    left_out: int = 0
    median: float | None = None
    largest: float | None = None
    exact_median: float | None = None
    exact_largest: float | None = None
    further: Mapping[str, float] = field(default_factory=dict)
    figure: str = ""

    def as_dict(self) -> dict:
        """Builtins for JSON, which has no NaN: what was not measured is None."""
        return _measured(asdict(self))


def judge(
    predicted: float, measured: float, uncertainty: float, tolerance: float, caveat: bool = False
) -> str:
    """Verdict on a claim.

    Parameters
    ----------
    predicted, measured, uncertainty : numbers
    tolerance : relative to |predicted| (absolute where it is 0)
    caveat : the claim holds only under a condition that the paper does not state

    Returns
    -------
    "not testable" without a finite measurement, uncertainty or prediction; "not reproduced" if the deviation exceeds
    the tolerance by more than the numerical uncertainty; "reproduced with caveat" if the tolerance lies within the
    uncertainty of the deviation, or a condition is attached; else "reproduced"
    """
    if not all(math.isfinite(value) for value in (predicted, measured, uncertainty)):
        return "not testable"
    scale = abs(predicted) if predicted != 0.0 else 1.0
    deviation = abs(measured - predicted) / scale
    blur = abs(uncertainty) / scale
    if deviation - blur > tolerance:
        return "not reproduced"
    if caveat or deviation + blur > tolerance:
        return "reproduced with caveat"
    return "reproduced"


def _measured(value: object) -> object:
    if isinstance(value, Mapping):
        return {key: _measured(entry) for key, entry in value.items()}
    return None if isinstance(value, float) and not math.isfinite(value) else value
