"""Results about a claim of the paper: a dataclass for each kind of claim."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Self

import numpy as np

from . import rules
from .rules import Uncertain

NAN = float("nan")


@dataclass(frozen=True, kw_only=True)
class Claim(ABC):
    """The result about one claim; every kind may have further numbers by name, and two texts.

    ``why`` is a sentence or two on the verdict, ``note`` replaces that in manuscript/claims.yaml,
    ``at_earlier`` is the verdict at an earlier tolerance, where no number is compared with it.
    """

    further: Mapping[str, float] = field(default_factory=dict)
    why: str = ""
    note: str = ""
    at_earlier: str = ""

    @abstractmethod
    def verdict(self) -> str:
        """The verdict at the tolerance of the claim."""

    @abstractmethod
    def fields(self) -> dict[str, Any]:
        """The verdict and the numbers of the kind, as claims.json names them."""

    def flips(self) -> list[dict]:
        """Tolerances at which the verdict changes; none if no number is compared with one."""
        return []

    def written(self) -> dict[str, Any]:
        """All fields in claims.json that the result sets."""
        rest = {"further": dict(self.further), "why": self.why, "flips_at": self.flips()}
        rest |= {"at_earlier": self.at_earlier} | ({"note": self.note} if self.note else {})
        return self.fields() | rest


@dataclass(frozen=True, kw_only=True)
class Qualitative(Claim):
    """An always, never or every, by the numbers of runs in which it holds, fails or is open.

    ``condition`` is true if it needs a condition that the paper does not state, ``premise`` if the
    paper does not say that it holds, but takes it for granted.
    """

    held: int
    failed: int = 0
    undecided: int = 0
    condition: bool = False
    premise: bool = False

    @classmethod
    def counted(cls, decided: Iterable[bool | None], **fields: Any) -> Self:
        """The claim from whether it holds in each run, None where that is undecided."""
        decided = list(decided)
        held = sum(bool(answer) for answer in decided)
        undecided = sum(answer is None for answer in decided)
        failed = len(decided) - held - undecided
        return cls(held=held, failed=failed, undecided=undecided, **fields)

    def verdict(self) -> str:
        verdict = rules.qualitative(self.held, self.failed, self.undecided, self.condition)
        return rules.UNMET if self.premise and verdict == rules.FAILED else verdict

    def fields(self) -> dict[str, Any]:
        runs, counts = self.held + self.failed + self.undecided, {"held": self.held}
        counts |= {"failed": self.failed, "undecided": self.undecided}
        out = {"verdict": self.verdict(), "predicted": runs, "measured": self.held}
        out |= {"uncertainty": self.undecided, "deviation": self.failed / runs if runs else None}
        return out | {"runs": runs} | counts


@dataclass(frozen=True, kw_only=True)
class ByNumber(Claim):
    """A claim that compares a number with a tolerance."""

    tolerance: float
    # The verdict, at a tolerance, on what must hold besides.
    besides: Callable[[float], str] | None = None
    # The paper does not make it.
    beyond: bool = False

    @abstractmethod
    def by_number(self, tolerance: float) -> str:
        """The verdict on the number alone if the tolerance were this one."""

    def verdict_at(self, tolerance: float) -> str:
        """The verdict if the tolerance were this one."""
        verdicts = [self.by_number(tolerance)]
        verdict = rules.worst(verdicts + ([self.besides(tolerance)] if self.besides else []))
        return rules.BEYOND if self.beyond and verdict == rules.FAILED else verdict

    def verdict(self) -> str:
        return self.verdict_at(self.tolerance)

    def flips(self) -> list[dict]:
        return rules.flips(self.verdict_at, self.tolerance)


@dataclass(frozen=True, kw_only=True)
class Equation(ByNumber):
    """An equation, by values of its runs at spacing 0: arrays [run], NaN without a value."""

    predicted: np.ndarray
    measured: np.ndarray
    uncertainty: np.ndarray
    # Numbers of runs of what must hold besides.
    counts: Mapping[str, int] = field(default_factory=dict)

    def relative(self) -> tuple[np.ndarray, np.ndarray]:
        """Deviation and uncertainty over what is predicted, absolute where that is 0, [run]."""
        scale = np.where(self.predicted == 0.0, 1.0, np.abs(self.predicted))
        return np.abs(self.measured - self.predicted) / scale, self.uncertainty / scale

    def by_number(self, tolerance: float) -> str:
        return rules.equation(*self.relative(), tolerance)[0]

    def fields(self) -> dict[str, Any]:
        """The numbers of the run that decides, and how many runs have numbers."""
        deviation, uncertainty = self.relative()
        usable = int(np.isfinite(deviation + uncertainty).sum())
        out: dict[str, Any] = {"verdict": self.verdict(), "runs": usable}
        out["left_out"] = len(deviation) - usable
        run = rules.equation(deviation, uncertainty, self.tolerance)[1]
        if run is not None:
            out |= {"predicted": float(self.predicted[run]), "measured": float(self.measured[run])}
            out |= {"uncertainty": float(self.uncertainty[run]), "deviation": float(deviation[run])}
        return out | dict(self.counts)


@dataclass(frozen=True, kw_only=True)
class Approximate(ByNumber):
    """An estimate, by the median deviation of its runs."""

    # |measured/predicted - 1| of the runs that have numbers, on the finest lattice.
    deviations: np.ndarray
    left_out: int
    # The medians of the deviation and of measured/predicted, with numerical uncertainties.
    median: Uncertain = (NAN, NAN)
    ratio: Uncertain = (NAN, NAN)
    # The median and largest deviation of runs at spacing 0 from the exact theory.
    from_exact: Uncertain | None = None

    def by_number(self, tolerance: float) -> str:
        return rules.within(*self.median, tolerance)

    def fields(self) -> dict[str, Any]:
        """The medians and the spread of the runs; only counts without runs."""
        runs = self.deviations.size
        out = {"runs": runs, "left_out": self.left_out, "verdict": self.verdict()}
        if self.from_exact is not None:
            out["exact_median"], out["exact_largest"] = self.from_exact
        if runs:
            out["measured"], out["uncertainty"] = self.ratio
            out |= {"predicted": 1.0, "deviation": self.median[0]}
            out["ninety"] = float(np.percentile(self.deviations, 90.0))
            out["largest"] = float(self.deviations.max())
        return out


@dataclass(frozen=True, kw_only=True)
class Scaling(ByNumber):
    """A proportionality, by the exponent of measured over predicted, which should be 1."""

    exponent: Uncertain
    runs: int

    def by_number(self, tolerance: float) -> str:
        return rules.within(abs(self.exponent[0] - 1.0), self.exponent[1], tolerance)

    def fields(self) -> dict[str, Any]:
        out: dict[str, Any] = {"verdict": self.verdict(), "runs": self.runs, "left_out": 0}
        out["predicted"] = 1.0
        out["measured"], out["uncertainty"] = self.exponent
        return out | {"deviation": abs(self.exponent[0] - 1.0)}


@dataclass(frozen=True, kw_only=True)
class Reading(ByNumber):
    """A figure that was read off, by chi-square of its readings at the best fit."""

    chi_square: float
    degrees_of_freedom: int
    p_value: float

    def by_number(self, tolerance: float) -> str:
        return rules.reading(self.p_value, self.degrees_of_freedom, tolerance)

    def fields(self) -> dict[str, Any]:
        out = {"verdict": self.verdict(), "predicted": float(self.degrees_of_freedom)}
        return out | {"measured": self.chi_square, "deviation": self.p_value}
