"""Results about claims of the paper: one class for each kind of claim.

A result has the measured numbers, and computes the verdict from them at any tolerance. So the
ledger can also report the tolerances at which the verdict would change.
"""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.special import chdtrc

from . import rules
from .rules import Spread, Uncertain

NAN = math.nan
# To find where the verdict changes, it is computed at this number of tolerances. The interval in
# which it changes is then halved this number of times.
SCANNED_TOLERANCES, BISECTIONS = 41, 12
# A qualitative claim is inconclusive if more than this fraction of its runs is undecided.
MAX_UNDECIDED_FRACTION = 0.1


@dataclass(frozen=True, kw_only=True)
class Claim(ABC):
    """The result about one claim.

    Attributes
    ----------
    tolerance
        Largest allowed deviation; 0 if no number is compared with a tolerance.
    extra_verdict
        Function that returns the verdict on an additional requirement at a given tolerance.
    failing
        Verdict on the claim if it fails. It is not always "not reproduced".
    further
        Additional numbers by name, for the table of claims.
    template_values
        Values by name for the sentences in manuscript/claims.yaml, in addition to `fields`.
    """

    tolerance: float = 0.0
    extra_verdict: Callable[[float], str] | None = None
    failing: str = rules.FAILED
    further: Mapping[str, float] = field(default_factory=dict)
    template_values: dict[str, Any] = field(default_factory=dict)

    @abstractmethod
    def own_verdict(self, tolerance: float) -> str:
        """Return the verdict at a tolerance, without the additional requirement."""

    @abstractmethod
    def fields(self) -> dict[str, Any]:
        """Return the verdict and the numbers, by their names in claims.json."""

    def verdict(self, tolerance: float | None = None) -> str:
        """Return the verdict at the tolerance of the claim, or at another tolerance.

        An additional requirement (``extra_verdict``) can make the verdict worse. A claim that fails
        gets its own verdict for this case (``failing``).
        """
        tolerance = self.tolerance if tolerance is None else tolerance
        verdict = self.own_verdict(tolerance)
        if self.extra_verdict is not None:
            verdict = rules.worst([verdict, self.extra_verdict(tolerance)])
        return self.failing if verdict == rules.FAILED else verdict

    def flips(self) -> list[dict]:
        """Return the tolerances at which the verdict changes, with the verdicts on both sides.

        The search covers one tenth to ten times the tolerance of the claim.
        """
        if not self.tolerance:
            return []
        factors = np.geomspace(0.1, 10.0, SCANNED_TOLERANCES)
        verdicts = [self.verdict(self.tolerance * factor) for factor in factors]
        flips = []
        for index in range(len(factors) - 1):
            below, above = verdicts[index], verdicts[index + 1]
            if below != above:
                factor = self._bisect_for_flip(factors[index], factors[index + 1], below)
                tolerance = float(self.tolerance * factor)
                flips.append({"tolerance": tolerance, "below": below, "above": above})
        return flips

    def _bisect_for_flip(self, low: float, high: float, verdict_at_low: str) -> float:
        """Find by bisection where the verdict changes, as a factor of the tolerance of the claim.

        low, high : factors between which the verdict changes
        """
        for _ in range(BISECTIONS):
            middle = np.sqrt(low * high)
            if self.verdict(self.tolerance * middle) == verdict_at_low:
                low = middle
            else:
                high = middle
        return high

    def json_fields(self) -> dict[str, Any]:
        """Return all fields of claims.json that the result sets."""
        return {"further": dict(self.further)} | self.fields() | {"flips_at": self.flips()}

    def sentence_values(self) -> dict[str, Any]:
        """Return the values that sentences may use in addition to the fields of claims.json."""
        return self.template_values


@dataclass(frozen=True, kw_only=True)
class Qualitative(Claim):
    """A statement with "always" or "never", which must hold in each run.

    decided : one value for each run: True if the statement holds, False if it fails, and None if
        the run does not decide
    has_caveat : True if the statement holds only under a condition that the paper does not state
    """

    decided: Collection[bool | None]
    has_caveat: bool = False

    def counts(self) -> dict[str, int]:
        """Return the numbers of runs in which the statement holds, fails or stays undecided."""
        held = sum(bool(answer) for answer in self.decided)
        undecided = sum(answer is None for answer in self.decided)
        failed = len(self.decided) - held - undecided
        return {"held": held, "failed": failed, "undecided": undecided}

    def own_verdict(self, tolerance: float) -> str:
        """Return the verdict from the numbers of runs; the tolerance has no influence.

        If the claim holds, it has a caveat with ``has_caveat``, or if a few runs are undecided.
        """
        counts, run_count = self.counts(), len(self.decided)
        if not run_count:
            return rules.NOT_TESTABLE
        if counts["failed"]:
            return rules.FAILED
        if counts["undecided"] > MAX_UNDECIDED_FRACTION * run_count:
            return rules.INCONCLUSIVE
        return rules.CAVEAT if counts["undecided"] or self.has_caveat else rules.REPRODUCED

    def fields(self) -> dict[str, Any]:
        """Return the numbers of runs; the deviation is the fraction of runs that fail."""
        run_count, counts = len(self.decided), self.counts()
        return {
            "verdict": self.verdict(),
            "runs": run_count,
            "predicted": run_count,
            **counts,
            "measured": counts["held"],
            "uncertainty": counts["undecided"],
            "deviation": counts["failed"] / run_count if run_count else None,
        }


@dataclass(frozen=True, kw_only=True)
class Equation(Claim):
    """An equation that must hold in each run.

    predicted : the value that the equation gives for each run; NaN where it is missing
    measured, uncertainty : the measured value and its numerical uncertainty; NaN where missing
    counts : additional numbers of runs for claims.json
    """

    predicted: np.ndarray
    measured: np.ndarray
    uncertainty: np.ndarray
    counts: Mapping[str, int] = field(default_factory=dict)

    def relative(self) -> tuple[np.ndarray, np.ndarray]:
        """Return the relative deviation and the relative uncertainty of each run.

        Both results are absolute where the predicted value is 0.
        """
        scale = np.where(self.predicted == 0.0, 1.0, np.abs(self.predicted))
        deviations = np.abs(self.measured - self.predicted) / scale
        return deviations, self.uncertainty / scale

    def verdicts(self, tolerance: float) -> list[str]:
        """Return the verdict on each run."""
        deviations, uncertainties = self.relative()
        return [
            rules.verdict_on_number(deviation, uncertainty, tolerance)
            for deviation, uncertainty in zip(deviations, uncertainties, strict=True)
        ]

    def own_verdict(self, tolerance: float) -> str:
        """Return the worst verdict of all runs that have numbers."""
        return rules.worst_tested(self.verdicts(tolerance))

    def fields(self) -> dict[str, Any]:
        """Return the numbers of the worst run, how many runs have numbers, and ``counts``.

        Of all runs with the worst verdict, the worst run is the one with the largest deviation.
        """
        deviations, uncertainties = self.relative()
        usable_count = int(np.isfinite(deviations + uncertainties).sum())
        fields: dict[str, Any] = {
            "verdict": self.verdict(),
            "runs": usable_count,
            "left_out": len(deviations) - usable_count,
        }
        if usable_count:
            verdicts = self.verdicts(self.tolerance)
            worst_verdict = rules.worst_tested(verdicts)
            worst_runs = [run for run, verdict in enumerate(verdicts) if verdict == worst_verdict]
            worst_run = max(worst_runs, key=lambda run: deviations[run])
            fields |= {
                "predicted": float(self.predicted[worst_run]),
                "measured": float(self.measured[worst_run]),
                "uncertainty": float(self.uncertainty[worst_run]),
                "deviation": float(deviations[worst_run]),
            }
        return fields | dict(self.counts)


NO_VALUE, NO_SPREAD = Uncertain(NAN, NAN), Spread(NAN, NAN)


@dataclass(frozen=True, kw_only=True)
class Approximate(Claim):
    """An estimate, which must hold in the median of its runs.

    deviations : |measured/predicted - 1| of each run on the finest lattice; NaN where a value is
        missing
    median : median of the deviations, with its numerical uncertainty
    ratio : median of measured/predicted, with its numerical uncertainty
    from_exact : deviations of our own values, extrapolated to spacing 0, from exact theory
    """

    deviations: np.ndarray
    median: Uncertain
    ratio: Uncertain = NO_VALUE
    from_exact: Spread = NO_SPREAD

    def own_verdict(self, tolerance: float) -> str:
        """Return the verdict on the median deviation."""
        median_deviation, uncertainty = self.median
        return rules.verdict_on_number(median_deviation, uncertainty, tolerance)

    def fields(self) -> dict[str, Any]:
        """Return the median ratio (measured), and statistics of the deviations of the runs.

        The statistics are the median (deviation) with its uncertainty, the 90th percentile (ninety)
        and the largest. They are left out if no run has a number. The fields exact_... have the
        deviations from exact theory.
        """
        usable_deviations = self.deviations[np.isfinite(self.deviations)]
        exact_median, exact_largest = self.from_exact
        fields: dict[str, Any] = {
            "runs": usable_deviations.size,
            "left_out": self.deviations.size - usable_deviations.size,
            "verdict": self.verdict(),
            "exact_median": exact_median,
            "exact_largest": exact_largest,
        }
        if usable_deviations.size:
            median_ratio, uncertainty = self.ratio
            fields |= {
                "measured": median_ratio,
                "uncertainty": uncertainty,
                "predicted": 1.0,
                "deviation": self.median.value,
                "deviation_uncertainty": self.median.uncertainty,
                "ninety": float(np.percentile(usable_deviations, 90.0)),
                "largest": float(usable_deviations.max()),
            }
        return fields


@dataclass(frozen=True, kw_only=True)
class Reading(Claim):
    """Numbers that were read off a figure, judged by their chi-square at the best fit.

    degrees_of_freedom : number of readings minus number of fitted parameters
    """

    chi_square: float
    degrees_of_freedom: int

    def p_value(self) -> float:
        """Return the probability of a larger chi-square; NaN if there is no degree of freedom."""
        degrees = self.degrees_of_freedom
        return float(chdtrc(degrees, self.chi_square)) if degrees else NAN

    def own_verdict(self, tolerance: float) -> str:
        """Return the verdict on the fit; the tolerance is the smallest p-value that is accepted."""
        p_value = self.p_value()
        if math.isnan(p_value):
            return rules.NOT_TESTABLE
        # One degree of freedom is too few to judge a fit.
        if self.degrees_of_freedom < 2:
            return rules.INCONCLUSIVE
        return rules.REPRODUCED if p_value >= tolerance else rules.FAILED

    def fields(self) -> dict[str, Any]:
        """Return the chi-square (measured), its expected value (predicted), and the p-value.

        The p-value takes the place of the deviation, because it is compared with the tolerance.
        """
        return {
            "verdict": self.verdict(),
            "predicted": float(self.degrees_of_freedom),
            "measured": self.chi_square,
            "deviation": self.p_value(),
        }
