"""What was measured on three lattices, with what is predicted, and from it a claim of each kind."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
import pandas as pd

from ..measure.uncertainty import GridStudy, grid_study
from . import rules

NAN = float("nan")
NUMBERS = ("predicted", "measured", "uncertainty", "deviation")
Where = Callable[[pd.DataFrame], pd.Series]


class NoRuns(Exception):
    """An altered configuration has left no runs to take a number from."""


@dataclass(frozen=True)
class Claim:
    """What was found about one claim; what it says stands in manuscript/claims.yaml.

    Attributes
    ----------
    id : short name
    verdict : one of `rules.VERDICTS`
    predicted, measured : numbers; for an approximate claim 1 and the median ratio, for a qualitative one the runs and
        how many it holds in, for a reading the degrees of freedom and chi-square
    uncertainty : numerical uncertainty of `measured`; for a qualitative claim how many runs are undecided
    deviation : what stands beside the tolerance: relative deviation, its median, fraction of runs that contradict, p
    numbers : what its kind has besides: runs and left_out (those without numbers); ninety and largest (quantile and
        largest deviation of the runs), exponent and exponent_uncertainty, exact_median and exact_largest (of the
        deviations of the runs at spacing 0 from the exact theory); held, failed and undecided
    further : other numbers, by what they are
    why : one sentence on why it is not simply reproduced, where its numbers do not say it
    note, source : in place of those that stand with the text
    """

    id: str
    verdict: str
    predicted: float = NAN
    measured: float = NAN
    uncertainty: float = NAN
    deviation: float = NAN
    numbers: Mapping[str, float | None] = field(default_factory=dict)
    further: Mapping[str, float] = field(default_factory=dict)
    why: str = ""
    note: str = ""
    source: str = ""


def line(table: pd.DataFrame, measured: str, predicted: str) -> float:
    """Exponent of measured against predicted: slope of a straight line in logarithmic axes."""
    x, y = np.log(table[predicted].to_numpy(float)), np.log(table[measured].to_numpy(float))
    good = np.isfinite(x) & np.isfinite(y)
    return float(np.polyfit(x[good], y[good], 1)[0]) if np.count_nonzero(good) > 2 else NAN


def deviations(table: pd.DataFrame, measured: str, predicted: str) -> np.ndarray:
    """|measured/predicted - 1| of each run, NaN where it has none."""
    return np.abs(table[measured].to_numpy(float) / table[predicted].to_numpy(float) - 1.0)


def agreeing(first: Iterable, second: Iterable) -> list[bool | None]:
    """What two lattices both say; None where they differ, or say nothing."""
    pairs = zip(first, second, strict=True)
    return [bool(one) if one is not None and one == other else None for one, other in pairs]


class Evidence:
    """What the ledger is computed from.

    Parameters
    ----------
    tables : per simulation measured and predicted numbers, and per study its table; of grid studies coarser/NAME and
        uncertainties/NAME
    entries : per claim, what manuscript/claims.yaml says of it
    steady : change of the largest velocity below which a pulse is steady, from the configuration
    """

    def __init__(
        self, tables: Mapping[str, pd.DataFrame], entries: Mapping[str, Mapping], steady: float = 0.02
    ) -> None:
        self.tables, self.entries, self.steady = tables, entries, steady
        self._lattices = {}
        for name in (path.removeprefix("coarser/") for path in tables if path.startswith("coarser/")):
            finest, coarser = tables[name], tables[f"coarser/{name}"]
            predicted = finest[finest.columns.difference(coarser.columns)]
            parts = [part.reset_index(drop=True) for _, part in coarser.groupby("factor")]
            kept = finest["run_flags"].isna() | (finest["run_flags"] == "")
            levels = [finest, *(part.join(predicted) for part in parts)]
            self._lattices[name] = [level[kept].assign(simulation=name) for level in levels]

    # Runs, without those that are flagged on the finest lattice, whose numbers are not those of the model

    def lattices(self, *simulations: str) -> list[pd.DataFrame]:
        """Tables of some simulations one below the other: on the finest lattice, the middle and the coarsest."""
        parts = zip(*(self._lattices[name] for name in simulations), strict=True)
        return [pd.concat(level, ignore_index=True) for level in parts]

    def runs(self, simulation: str, where: Where | None = None) -> pd.DataFrame:
        """Runs on the finest lattice.

        Raises
        ------
        NoRuns
        """
        table = self.lattices(simulation)[0]
        table = table if where is None else table[where(table)]
        if table.empty:
            raise NoRuns(simulation)
        return table

    def points(self, simulation: str, quantity: str, where: Where | None = None) -> pd.DataFrame:
        """Runs of a sweep, by number, with one quantity: value, extrapolated to spacing 0, uncertainty."""
        study = self.tables[f"uncertainties/{simulation}"]
        study = study[study["quantity"] == quantity].set_index("point")
        table = self._lattices[simulation][0]
        points = table.join(study[["value", "extrapolated", "uncertainty"]])
        return points if where is None else points[where(points)]

    def studied(self, tables: Sequence[pd.DataFrame], number: Callable[[pd.DataFrame], float]) -> GridStudy:
        """Grid study of a number that is computed from a table, as a median is; of one table, no uncertainty."""
        values = [number(table) for table in tables]
        if len(tables) == 1:
            return GridStudy(values[0], values[0], NAN, 0.0)
        return grid_study(values, [float(table["factor"].dropna().iloc[0]) for table in tables[1:]])

    def tolerance(self, id: str) -> float:
        """Tolerance of a claim."""
        return float(self.entries[id]["tolerance"])

    # A claim of each kind

    def exact(self, id: str, points: pd.DataFrame, predicted: Iterable[float]) -> Claim:
        """An equation, by the values of its runs at spacing 0.

        Parameters
        ----------
        points : runs with columns extrapolated and uncertainty
        predicted : what the paper has for each; 0 is compared without division
        """
        paper = np.asarray(list(predicted), dtype=float)
        scale = np.where(paper == 0.0, 1.0, np.abs(paper))
        value, uncertainty = (points[name].to_numpy(float) for name in ("extrapolated", "uncertainty"))
        deviation, blur = np.abs(value - paper) / scale, uncertainty / scale
        verdict, run = rules.exact(deviation, blur, self.tolerance(id))
        usable = int(np.isfinite(deviation + blur).sum())
        claim = Claim(id, verdict, numbers={"runs": usable, "left_out": len(points) - usable})
        if run is None:
            return claim
        numbers = (each[run] for each in (paper, value, uncertainty, deviation))
        return replace(claim, **dict(zip(NUMBERS, numbers, strict=True)))

    def approximate(
        self,
        id: str,
        tables: Sequence[pd.DataFrame],
        measured: str,
        predicted: str,
        levels: Sequence[str] = (),
    ) -> Claim:
        """An estimate, by the median deviation of its runs and, where a tolerance is given for it, the exponent.

        Parameters
        ----------
        tables : the same runs on the finest lattice, the middle and the coarsest; or one table of exact values
        measured, predicted : columns
        levels : columns of which one level at a time is left out, for the uncertainty of the exponent
        """
        each = deviations(tables[0], measured, predicted)
        each = each[np.isfinite(each)]
        names = ("ninety", "largest", "exponent", "exponent_uncertainty", "exact_median", "exact_largest")
        numbers = {"runs": each.size, "left_out": len(tables[0]) - each.size, **dict.fromkeys(names)}
        if not each.size:
            return Claim(id, "not testable", numbers=numbers)
        median = self.studied(tables, lambda t: float(np.nanmedian(deviations(t, measured, predicted))))
        ratio = self.studied(tables, lambda t: float(np.nanmedian(t[measured] / t[predicted])))
        exponent, allowed = None, self.entries[id].get("tolerance_exponent")
        if allowed is not None:
            found = self.studied(tables, lambda t: line(t, measured, predicted))
            without = [
                line(tables[0][tables[0][name] != level], measured, predicted)
                for name in levels
                for level in tables[0][name].unique()
            ]
            moved = max((abs(other - found.value) for other in without), default=0.0)
            exponent = found.value, max(found.uncertainty, moved)
            numbers |= {"exponent": exponent[0], "exponent_uncertainty": exponent[1]}
        numbers |= {"ninety": float(np.quantile(each, 0.9)), "largest": float(each.max())}
        verdict = rules.approximate(
            (median.value, median.uncertainty), self.tolerance(id), exponent, float(allowed or 0.0)
        )
        return Claim(id, verdict, 1.0, ratio.value, ratio.uncertainty, median.value, numbers)

    def qualitative(self, id: str, decided: Iterable[bool | None], condition: bool = False) -> Claim:
        """An always, never or every.

        Parameters
        ----------
        decided : of each run whether it holds; None where that is undecided
        condition : whether it needs one that the paper does not state
        """
        decided = list(decided)
        known = [bool(found) for found in decided if found is not None]
        runs, held, failed = len(decided), sum(known), known.count(False)
        numbers = {"runs": runs, "held": held, "failed": failed, "undecided": runs - len(known)}
        verdict = rules.qualitative(held, failed, runs - len(known), condition)
        return Claim(id, verdict, runs, held, runs - len(known), failed / runs if runs else NAN, numbers)

    def agreed(
        self,
        simulation: str,
        where: Where,
        holds: Where,
        exactly: Where | None = None,
        told: Where | None = None,
    ) -> list[bool | None]:
        """Of each run of a sweep whether it holds: as the two finest lattices agree, else as the exact solution says.

        Parameters
        ----------
        where : which runs
        holds : whether it holds, on one lattice
        exactly : the same by the exact solution; None or NA where that does not tell
        told : which runs last long enough for a lattice to tell; all of them if not given
        """
        finest, middle, *_ = self.lattices(simulation)
        every = pd.Series(True, finest.index)
        both = agreeing(np.asarray(holds(finest), bool), np.asarray(holds(middle), bool))
        theory = [None] * len(finest) if exactly is None else exactly(finest).tolist()
        rows = zip(where(finest), every if told is None else told(finest), both, theory, strict=True)
        return [
            found if seen and found is not None else None if exact is None or pd.isna(exact) else bool(exact)
            for chosen, seen, found, exact in rows
            if chosen
        ]

    def compared(self, claim: Claim, simulation: str, quantity: str) -> Claim:
        """The claim with the median and the largest deviation of its runs at spacing 0 from the exact theory."""
        deviation = deviations(self.points(simulation, quantity), "extrapolated", f"exact_{quantity}")
        deviation = deviation[np.isfinite(deviation)]
        if deviation.size == 0:
            return claim
        exact = {"exact_median": float(np.median(deviation)), "exact_largest": float(deviation.max())}
        return replace(claim, numbers={**claim.numbers, **exact})
