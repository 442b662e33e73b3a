"""One claim of the ledger: what the paper says, what was found, the verdict."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field


@dataclass(frozen=True)
class Claim:
    """One entry of the ledger.

    Attributes
    ----------
    id : short name
    kind : one of `slippulse.configuration.kinds.KINDS`
    predicted, measured : numbers; for an approximate claim 1 and the median ratio, for a qualitative one the runs and
        how many it holds in, for a reading the degrees of freedom and chi-square
    uncertainty : numerical uncertainty of `measured`; for a qualitative claim how many runs are undecided
    tolerance : as the configuration has it, by kind
    deviation : what stands beside the tolerance: relative deviation, its median, share of the runs that contradict, p
    verdict : one of `slippulse.claims.rules.VERDICTS`
    note : what was measured, and what else there is to know; Markdown with TeX, as the keys of further
    source : the data, function or derivation behind it
    figure_or_section : where the paper says it
    statement : what it says, in our words
    follows_from : claims that it follows from; it is not counted again
    figure : name of the figure that shows it
    runs : how many runs it was judged by
    left_out : runs without numbers, which were not
    held, failed, undecided : of a qualitative claim, how many runs
    ninety, largest : of an approximate claim, 90 % quantile and largest deviation of the runs
    exponent, exponent_uncertainty, tolerance_exponent : of measured against predicted, in logarithmic axes
    exact_median, exact_largest : of the deviations of the runs at spacing 0 from the exact theory
    further : other numbers, by what they are
    why : one sentence on why it is not simply reproduced
    """

    id: str
    kind: str
    predicted: float
    measured: float
    uncertainty: float
    tolerance: float
    deviation: float
    verdict: str
    note: str
    source: str
    figure_or_section: str = ""
    statement: str = ""
    counted: bool = True
    follows_from: tuple[str, ...] = ()
    figure: str = ""
    runs: int | None = None
    left_out: int = 0
    held: int | None = None
    failed: int | None = None
    undecided: int | None = None
    ninety: float | None = None
    largest: float | None = None
    exponent: float | None = None
    exponent_uncertainty: float | None = None
    tolerance_exponent: float | None = None
    exact_median: float | None = None
    exact_largest: float | None = None
    further: Mapping[str, float] = field(default_factory=dict)
    why: str = ""

    def as_dict(self) -> dict:
        """Builtins for JSON, which has no NaN: what was not measured is None."""
        return finite(asdict(self))


def finite(value: object) -> object:
    """Builtins with None for every number that JSON does not have."""
    if isinstance(value, Mapping):
        return {key: finite(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [finite(entry) for entry in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value
