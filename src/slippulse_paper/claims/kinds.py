"""Results about a claim of the paper: a dataclass for each kind of claim."""

import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy.special import chdtrc

from . import rules
from .rules import Uncertain

NAN = math.nan
# The number of tolerances at which a verdict is computed, and of halvings where it changes.
SCANNED, BISECTED = 41, 12
# A qualitative claim stays open if a larger fraction of its runs is undecided.
MOST_UNDECIDED = 0.1


@dataclass(frozen=True, kw_only=True)
class Claim(ABC):
    """The result about one claim; every kind may have further numbers by name.

    ``tolerance`` is 0 where no number is compared with one. ``besides`` has the verdict, at a
    tolerance, on what must hold besides; ``failing`` is the verdict on a claim that fails.
    ``told`` has what the sentences of manuscript/claims.yaml on the claim tell besides, by name.
    """

    tolerance: float = 0.0
    besides: Callable[[float], str] | None = None
    failing: str = rules.FAILED
    further: Mapping[str, float] = field(default_factory=dict)
    told: dict[str, Any] = field(default_factory=dict)

    @abstractmethod
    def alone(self, tolerance: float) -> str:
        """The verdict on the numbers of the kind alone if the tolerance were this one."""

    @abstractmethod
    def fields(self) -> dict[str, Any]:
        """The verdict and the numbers of the kind, as claims.json names them."""

    def verdict(self, tolerance: float | None = None) -> str:
        """The verdict at the tolerance of the claim, or if it were another one."""
        tolerance = self.tolerance if tolerance is None else tolerance
        verdict = self.alone(tolerance)
        if self.besides is not None:
            verdict = rules.worst([verdict, self.besides(tolerance)])
        return self.failing if verdict == rules.FAILED else verdict

    def flips(self) -> list[dict]:
        """Tolerances, a tenth to ten times, at which the verdict changes, and both verdicts."""
        if not self.tolerance:
            return []
        factors = np.geomspace(0.1, 10.0, SCANNED)
        verdicts = [self.verdict(self.tolerance * factor) for factor in factors]
        out = []
        for i in np.flatnonzero(np.array(verdicts[1:]) != verdicts[:-1]):
            low, high = factors[i : i + 2]
            for _ in range(BISECTED):
                middle = np.sqrt(low * high)
                if self.verdict(self.tolerance * middle) == verdicts[i]:
                    low = middle
                else:
                    high = middle
            sides = {"below": verdicts[i], "above": verdicts[i + 1]}
            out.append({"tolerance": float(self.tolerance * high)} | sides)
        return out

    def written(self) -> dict[str, Any]:
        """All fields in claims.json that the result sets."""
        return {"further": dict(self.further)} | self.fields() | {"flips_at": self.flips()}

    def names(self) -> dict[str, Any]:
        """What sentences tell besides these fields."""
        return self.told


@dataclass(frozen=True, kw_only=True)
class Qualitative(Claim):
    """An always, never or every, by whether it holds in each run, None where that is undecided."""

    decided: Collection[bool | None]
    # Whether it needs a condition that the paper does not state.
    condition: bool = False

    def counts(self) -> dict[str, int]:
        """Numbers of runs in which it holds, fails or is open."""
        held = sum(bool(answer) for answer in self.decided)
        undecided = sum(answer is None for answer in self.decided)
        failed = len(self.decided) - held - undecided
        return {"held": held, "failed": failed, "undecided": undecided}

    def alone(self, tolerance: float) -> str:
        counts, runs = self.counts(), len(self.decided)
        if not runs:
            return rules.NOT_TESTABLE
        if counts["failed"]:
            return rules.FAILED
        if counts["undecided"] > MOST_UNDECIDED * runs:
            return rules.INCONCLUSIVE
        return rules.CAVEAT if counts["undecided"] or self.condition else rules.REPRODUCED

    def fields(self) -> dict[str, Any]:
        runs, counts = len(self.decided), self.counts()
        out = {"verdict": self.verdict(), "runs": runs, "predicted": runs, **counts}
        out |= {"measured": counts["held"], "uncertainty": counts["undecided"]}
        return out | {"deviation": counts["failed"] / runs if runs else None}


@dataclass(frozen=True, kw_only=True)
class Equation(Claim):
    """An equation, by values of its runs at spacing 0, or an exponent."""

    # Arrays [run], NaN without a value.
    predicted: np.ndarray
    measured: np.ndarray
    uncertainty: np.ndarray
    # Numbers of other runs: of those behind an exponent, or of what must hold besides.
    counts: Mapping[str, int] = field(default_factory=dict)

    def relative(self) -> tuple[np.ndarray, np.ndarray]:
        """Deviation and uncertainty over what is predicted, absolute where that is 0, [run]."""
        scale = np.where(self.predicted == 0.0, 1.0, np.abs(self.predicted))
        return np.abs(self.measured - self.predicted) / scale, self.uncertainty / scale

    def verdicts(self, tolerance: float) -> list[str]:
        """The verdict on each run."""
        return [rules.within(*pair, tolerance) for pair in zip(*self.relative(), strict=True)]

    def alone(self, tolerance: float) -> str:
        return rules.worst_tested(self.verdicts(tolerance))

    def fields(self) -> dict[str, Any]:
        """The numbers of the run that decides, the farthest off, and how many runs have numbers."""
        deviation, uncertainty = self.relative()
        usable = int(np.isfinite(deviation + uncertainty).sum())
        out: dict[str, Any] = {"verdict": self.verdict(), "runs": usable}
        out["left_out"] = len(deviation) - usable
        if usable:
            worst, verdicts = self.alone(self.tolerance), self.verdicts(self.tolerance)
            deciding = [run for run, verdict in enumerate(verdicts) if verdict == worst]
            run = max(deciding, key=deviation.__getitem__)
            out |= {"predicted": float(self.predicted[run]), "measured": float(self.measured[run])}
            out |= {"uncertainty": float(self.uncertainty[run]), "deviation": float(deviation[run])}
        return out | dict(self.counts)


@dataclass(frozen=True, kw_only=True)
class Approximate(Claim):
    """An estimate, by the median deviation of its runs."""

    # |measured/predicted - 1| of each run on the finest lattice, NaN without a value.
    deviations: np.ndarray
    # The medians of the deviation and of measured/predicted, with numerical uncertainties.
    median: Uncertain
    ratio: Uncertain = (NAN, NAN)
    # The median and largest deviation of runs at spacing 0 from the exact theory.
    from_exact: Uncertain = (NAN, NAN)

    def alone(self, tolerance: float) -> str:
        return rules.within(*self.median, tolerance)

    def fields(self) -> dict[str, Any]:
        """The medians and the spread of the runs; only counts without runs."""
        usable = self.deviations[np.isfinite(self.deviations)]
        out: dict[str, Any] = {"runs": usable.size, "left_out": self.deviations.size - usable.size}
        out["verdict"] = self.verdict()
        out["exact_median"], out["exact_largest"] = self.from_exact
        if usable.size:
            out["measured"], out["uncertainty"] = self.ratio
            out |= {"predicted": 1.0, "deviation": self.median[0]}
            out["ninety"] = float(np.percentile(usable, 90.0))
            out["largest"] = float(usable.max())
        return out


@dataclass(frozen=True, kw_only=True)
class Reading(Claim):
    """A figure that was read off, by chi-square of its readings at the best fit."""

    chi_square: float
    # The readings less the fitted parameters.
    degrees_of_freedom: int

    def p_value(self) -> float:
        """Probability of a larger chi-square; NaN without degrees of freedom."""
        degrees = self.degrees_of_freedom
        return float(chdtrc(degrees, self.chi_square)) if degrees else NAN

    def alone(self, tolerance: float) -> str:
        p = self.p_value()
        if math.isnan(p):
            return rules.NOT_TESTABLE
        if self.degrees_of_freedom < 2:
            return rules.INCONCLUSIVE
        return rules.REPRODUCED if p >= tolerance else rules.FAILED

    def fields(self) -> dict[str, Any]:
        out = {"verdict": self.verdict(), "predicted": float(self.degrees_of_freedom)}
        return out | {"measured": self.chi_square, "deviation": self.p_value()}
