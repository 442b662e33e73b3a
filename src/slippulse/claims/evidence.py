"""What was measured on three lattices, and from it a claim of each kind."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from ..measure.uncertainty import GridStudy, grid_study
from . import rules
from .ledger import Claim

NAN = float("nan")
ROUNDING = float(np.finfo(float).eps) * 8.0


def unflagged(table: pd.DataFrame) -> pd.Series:
    """Runs whose numbers are those of the model."""
    return table["run_flags"].isna() | (table["run_flags"] == "")


def line(table: pd.DataFrame, measured: str, predicted: str) -> float:
    """Exponent of measured against predicted: slope of a straight line in logarithmic axes."""
    x, y = np.log(table[predicted].to_numpy(float)), np.log(table[measured].to_numpy(float))
    good = np.isfinite(x) & np.isfinite(y)
    return float(np.polyfit(x[good], y[good], 1)[0]) if np.count_nonzero(good) > 2 else NAN


def deviations(table: pd.DataFrame, measured: str, predicted: str) -> np.ndarray:
    """|measured/predicted - 1| of each run, NaN where it has none."""
    return np.abs(table[measured].to_numpy(float) / table[predicted].to_numpy(float) - 1.0)


@dataclass(frozen=True)
class Evidence:
    """What the ledger is computed from.

    Attributes
    ----------
    measured : per simulation, one row a run
    coarser : per simulation, the measured tables of the coarser lattices, finer first
    uncertainties : per simulation, the grid study of every number of every run
    settings : per claim, kind, tolerance and so on, from the configuration
    steady : change of the largest velocity below which a pulse is steady, from the configuration
    still : share of the largest velocity below which a point is at rest, from the configuration
    """

    measured: Mapping[str, pd.DataFrame]
    coarser: Mapping[str, list[pd.DataFrame]]
    uncertainties: Mapping[str, pd.DataFrame]
    settings: Mapping[str, Mapping]
    steady: float = 0.02
    still: float = 0.05

    # Runs

    def lattices(self, *simulations: str) -> list[pd.DataFrame]:
        """Tables of some simulations one below the other: on the finest lattice, the middle and the coarsest.

        Runs that are flagged on the finest one are left out of all.
        """
        parts: list[list[pd.DataFrame]] = []
        for name in simulations:
            kept = unflagged(self.measured[name]).to_numpy()
            tables = (self.measured[name], *self.coarser[name])
            parts.append([table.reset_index(drop=True)[kept].assign(simulation=name) for table in tables])
        return [pd.concat(level, ignore_index=True) for level in zip(*parts, strict=True)]

    def points(self, simulation: str, quantity: str) -> pd.DataFrame:
        """Unflagged runs of a sweep with one quantity: value, extrapolated to spacing 0, uncertainty."""
        study = self.uncertainties[simulation]
        study = study[study["quantity"] == quantity].set_index("point")
        table = self.measured[simulation].reset_index(drop=True)
        columns = {
            name: study[name].reindex(table.index) for name in ("value", "extrapolated", "uncertainty")
        }
        return table.assign(simulation=simulation, **columns)[unflagged(table).to_numpy()]

    def studied(self, tables: Sequence[pd.DataFrame], number: Callable[[pd.DataFrame], float]) -> GridStudy:
        """Grid study of a number that is computed from a table, as a median is; of one table, no uncertainty."""
        values = tuple(number(table) for table in tables)
        if len(tables) == 1:
            return GridStudy(values[0], values[0], NAN, 0.0)
        factors = tuple(float(table["factor"].dropna().iloc[0]) for table in tables[1:])
        return grid_study(values, factors)

    def tolerance(self, id: str) -> float:
        """Tolerance of a claim."""
        return float(self.settings[id]["tolerance"])

    def claim(self, id: str, source: str, verdict: str, **fields) -> Claim:
        """A claim with kind and tolerance from the configuration."""
        empty = dict.fromkeys(("predicted", "measured", "uncertainty", "deviation"), NAN)
        entry = self.settings[id]
        return Claim(
            **{"note": "", **empty, **fields}, id=id, kind=entry["kind"], tolerance=self.tolerance(id),
            tolerance_exponent=entry.get("tolerance_exponent"), verdict=verdict, source=source,
            follows_from=tuple(entry.get("follows_from", ())), counted="follows_from" not in entry,
        )  # fmt: skip

    # A claim of each kind

    def exact(
        self, id: str, source: str, points: pd.DataFrame, predicted: Iterable[float], note: str = ""
    ) -> Claim:
        """An equation, by the values of its runs at spacing 0.

        Parameters
        ----------
        points : runs with columns extrapolated and uncertainty
        predicted : what the paper has for each; 0 is compared without division
        """
        predicted = np.asarray(list(predicted), dtype=float)
        scale = np.where(predicted == 0.0, 1.0, np.abs(predicted))
        value, uncertainty = (points[name].to_numpy(float) for name in ("extrapolated", "uncertainty"))
        deviation, blur = np.abs(value - predicted) / scale, uncertainty / scale
        verdict, run = rules.exact(deviation, blur, self.tolerance(id))
        usable = int(np.isfinite(deviation + blur).sum())
        found = {"runs": usable, "left_out": len(points) - usable, "note": note}
        if run is not None:
            found |= {
                "predicted": predicted[run], "measured": value[run], "uncertainty": uncertainty[run],
                "deviation": deviation[run],
            }  # fmt: skip
        return self.claim(id, source, verdict, **found)

    def approximate(
        self, id: str, source: str, tables: Sequence[pd.DataFrame], measured: str, predicted: str,
        levels: Sequence[str] = (), note: str = "",
    ) -> Claim:  # fmt: skip
        """An estimate, by the median deviation of its runs and, where a tolerance is given for it, the exponent.

        Parameters
        ----------
        tables : the same runs on the finest lattice, the middle and the coarsest; or one table of exact values
        measured, predicted : columns
        levels : columns of which one level at a time is left out, for the uncertainty of the exponent
        """
        each = deviations(tables[0], measured, predicted)
        if not np.isfinite(each).any():
            return self.claim(id, source, "not testable", note=note, left_out=len(tables[0]))
        median = self.studied(
            tables, lambda table: float(np.nanmedian(deviations(table, measured, predicted)))
        )
        finest = tables[0]
        exponent, allowed = None, self.settings[id].get("tolerance_exponent")
        if allowed is not None:
            found = self.studied(tables, lambda table: line(table, measured, predicted))
            without = [
                line(finest[finest[name] != level], measured, predicted)
                for name in levels
                for level in finest[name].unique()
            ]
            moved = max((abs(other - found.value) for other in without), default=0.0)
            exponent = found.value, max(found.uncertainty, moved)
        each = each[np.isfinite(each)]
        ratio = self.studied(tables, lambda table: float(np.nanmedian(table[measured] / table[predicted])))
        return self.claim(
            id, source,
            rules.approximate((median.value, median.uncertainty), self.tolerance(id), exponent, allowed),
            predicted=1.0, measured=ratio.value, uncertainty=ratio.uncertainty, deviation=median.value, note=note,
            runs=int(each.size), left_out=len(finest) - int(each.size),
            ninety=float(np.quantile(each, 0.9)), largest=float(each.max()),
            exponent=exponent and exponent[0], exponent_uncertainty=exponent and exponent[1],
        )  # fmt: skip

    def qualitative(
        self, id: str, source: str, decided: Iterable[bool | None], note: str = "", condition: bool = False
    ) -> Claim:
        """An always, never or every.

        Parameters
        ----------
        decided : of each run whether it holds; None where that is undecided
        condition : whether it needs one that the paper does not state
        """
        decided = list(decided)
        held, failed = (
            sum(found is not None and bool(found) is want for found in decided) for want in (True, False)
        )
        undecided = len(decided) - held - failed
        return self.claim(
            id, source, rules.qualitative(held, failed, undecided, condition),
            predicted=float(len(decided)), measured=float(held), uncertainty=float(undecided),
            deviation=failed / len(decided) if decided else NAN,
            note=note, runs=len(decided), held=held, failed=failed, undecided=undecided,
        )  # fmt: skip

    def agreed(
        self, simulation: str, where: Callable[[pd.DataFrame], pd.Series], holds: Callable[[pd.DataFrame], pd.Series],
        exactly: Callable[[tuple], bool | None] = lambda row: None,
        long_enough: Callable[[pd.DataFrame], pd.Series] | None = None,
    ) -> list[bool | None]:  # fmt: skip
        """Of each run of a sweep whether it holds: as the two finest lattices agree, else as the exact solution says.

        Parameters
        ----------
        where : which runs
        holds : whether it holds, on one lattice
        exactly : the same of a row by the exact solution; None where that does not tell
        long_enough : which runs last long enough for a lattice to tell; all of them if not given
        """
        finest, middle, *_ = self.lattices(simulation)
        first, second = (np.asarray(holds(table), dtype=bool) for table in (finest, middle))
        told = np.ones(len(finest), dtype=bool) if long_enough is None else long_enough(finest).to_numpy(bool)
        return [
            bool(first[i]) if told[i] and first[i] == second[i] else exactly(row)
            for i, (row, chosen) in enumerate(zip(finest.itertuples(), where(finest), strict=True))
            if chosen
        ]

    def arithmetic(self, id: str, source: str, ratio: float, note: str = "", **further: float) -> Claim:
        """A formula, by its ratio to the derived one at the parameters where they are farthest apart."""
        deviation = abs(ratio - 1.0)
        return self.claim(
            id, source, rules.arithmetic(deviation, self.tolerance(id)), predicted=1.0, measured=ratio,
            uncertainty=ROUNDING, deviation=deviation, note=note, further=further,
        )  # fmt: skip


def compared(claim: Claim, values: Iterable[float], exact: Iterable[float]) -> Claim:
    """The claim with the median and the largest relative deviation of its runs from the exact theory."""
    deviation = np.abs(np.asarray(list(values), dtype=float) / np.asarray(list(exact), dtype=float) - 1.0)
    deviation = deviation[np.isfinite(deviation)]
    if deviation.size == 0:
        return claim
    return replace(claim, exact_median=float(np.median(deviation)), exact_largest=float(deviation.max()))
