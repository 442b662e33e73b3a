"""What was measured on three lattices, with what is predicted, and from it a claim of each kind."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from ..measure.fronts import straight_line
from ..measure.regime import UNDECIDED
from ..measure.uncertainty import GridStudy, grid_study
from . import rules

NAN = float("nan")
# What was found about one claim: its verdict, and where it has them
# predicted, measured: of an approximate claim 1 and the median ratio, of a qualitative one the runs and how many it
#     holds in, of a reading the degrees of freedom and chi-square;
# uncertainty: of `measured`, numerically; of a qualitative claim how many runs are undecided;
# deviation: what stands beside the tolerance: relative deviation, its median, fraction of runs that contradict, p;
# runs and left_out (those without numbers), held, failed and undecided; `ESTIMATE`;
# choices: of each combination of what the paper leaves open its values by name, deviation, exponent, verdict and holds;
#     combinations and holds_at: how many; choice: the one that moves the deviation most;
# flips_at: tolerances at which the verdict changes (`rules.flips`), found by `at`, which is the verdict at a tolerance;
# further: other numbers, by what they are; why: one sentence, where the numbers do not say it; note.
Claim = dict[str, Any]
# Of an approximate claim: quantile and largest deviation of the runs, exponent, distance from the exact theory.
ESTIMATE = (
    "ninety",
    "largest",
    "exponent",
    "exponent_uncertainty",
    "exact_median",
    "exact_largest",
)


class NoRuns(Exception):
    """An altered configuration has left no runs to take a number from."""


def evaluated(table: pd.DataFrame, expression: str) -> np.ndarray:
    """An expression over columns, of each run; true of every run if it is empty."""
    if expression in table:  # Sparing most of the time.
        return table[expression].to_numpy()
    # Every column costs time, whether it is named or not.
    named = table[[name for name in table if name in expression]]
    found = named.eval(expression, engine="python") if expression else True
    return np.broadcast_to(np.asarray(found), len(table))


def ratios(table: pd.DataFrame, measured: str, predicted: str) -> pd.Series:
    """measured/predicted of each run, both expressions; NaN where it has none."""
    return pd.Series(evaluated(table, measured) / evaluated(table, predicted), table.index, float)


def exponent(logs: np.ndarray) -> float:
    """Slope of a straight line through the logarithms of two quantities, [2, run]; NaN with fewer than three runs."""
    x, y = logs[:, np.isfinite(logs).all(axis=0)]
    return straight_line(x, y)[0] if x.size > 2 else NAN


def agreeing(first: Iterable, second: Iterable) -> list[bool | None]:
    """What two lattices both say; None where they differ, or say nothing."""
    pairs = zip(first, second, strict=True)
    return [bool(one) if one is not None and one == other else None for one, other in pairs]


class Evidence:
    """What the ledger is computed from; ``steady``: change of the largest velocity below which a pulse is steady.

    Tables are of each simulation, with coarser/NAME and uncertainties/NAME of its grid study, and of each study. Which
    of their runs, and what is to hold in them, are expressions over columns (`pandas.DataFrame.eval`).
    """

    def __init__(
        self, tables: Mapping[str, pd.DataFrame], entries: Mapping[str, Mapping], steady: float
    ) -> None:
        self.tables, self.entries, self.steady = tables, entries, steady
        self.swept = [
            path.removeprefix("coarser/") for path in tables if path.startswith("coarser/")
        ]
        self._lattices = {}
        for name in self.swept:
            finest, coarser = tables[name], tables[f"coarser/{name}"]
            study = tables[f"uncertainties/{name}"].set_index(["point", "quantity"])
            study = study[["extrapolated", "uncertainty"]].unstack()
            study.columns = ["_".join(column) for column in study.columns]
            predicted = finest[finest.columns.difference(coarser.columns)]
            parts = [part.reset_index(drop=True) for _, part in coarser.groupby("factor")]
            levels = [finest.join(study), *(part.join(predicted) for part in parts)]
            # The numbers of runs that are flagged on the finest lattice are not those of the model.
            kept = finest["run_flags"].isna() | (finest["run_flags"] == "")
            self._lattices[name] = [level[kept] for level in levels]

    def assign(
        self, simulation: str, more: Callable[[pd.DataFrame], Mapping[str, pd.Series]]
    ) -> None:
        """Add columns that are computed from the others on each lattice."""
        self._lattices[simulation] = [
            level.assign(**more(level)) for level in self._lattices[simulation]
        ]

    def lattices(self, *simulations: str, where: str = "") -> list[pd.DataFrame]:
        """Runs on three lattices, the finest with uncertainty_QUANTITY and extrapolated_QUANTITY, at spacing 0."""
        chosen = [
            (self._lattices[name], evaluated(self._lattices[name][0], where))
            for name in simulations
        ]
        return [pd.concat([levels[i][kept] for levels, kept in chosen]) for i in range(3)]

    def tolerance(self, id: str) -> float:
        """Tolerance of a claim."""
        return float(self.entries[id]["tolerance"])

    # A claim of each kind

    def exact(self, id: str, table: pd.DataFrame, quantity: str, predicted: str) -> Claim:
        """An equation, by values of its runs at spacing 0; where 0 is predicted, without division."""
        names = f"extrapolated_{quantity}", f"uncertainty_{quantity}", predicted
        value, blur, paper = (evaluated(table, name).astype(float) for name in names)
        scale = np.where(paper == 0.0, 1.0, np.abs(paper))
        numbers = {"predicted": paper, "measured": value, "uncertainty": blur}
        numbers["deviation"] = off = np.abs(value - paper) / scale
        judge, usable = partial(rules.exact, off, blur / scale), int(np.isfinite(off + blur).sum())
        verdict, run = judge(self.tolerance(id))
        counts = {"runs": usable, "left_out": len(value) - usable}
        shown = {} if run is None else {name: float(each[run]) for name, each in numbers.items()}
        return {"verdict": verdict, "at": lambda tolerance: judge(tolerance)[0]} | counts | shown

    def studied(self, tables: Sequence[pd.DataFrame], values: Sequence[float]) -> GridStudy:
        """Grid study of a number that was computed from each table, as a median is; of one table, no uncertainty."""
        if len(tables) == 1:
            return GridStudy(values[0], values[0], NAN, 0.0)
        return grid_study(values, [float(table["factor"].dropna().iloc[0]) for table in tables[1:]])

    def approximate(
        self, id: str, tables: Sequence[pd.DataFrame], measured: str, predicted: str, *levels: str
    ) -> Claim:
        """An estimate, by median deviation and exponent, which leaves out one of the ``levels`` at a time too."""
        numbers = [
            np.array([evaluated(t, name) for name in (predicted, measured)], float) for t in tables
        ]
        ratio = [pd.Series(found / expected) for expected, found in numbers]
        off = [(each - 1.0).abs() for each in ratio]
        each = off[0][np.isfinite(off[0])]
        claim: Claim = {"runs": each.size, "left_out": len(off[0]) - each.size}
        if not each.size:
            return claim | {"verdict": "not testable"}
        median, shown = (
            self.studied(tables, [each.median() for each in of]) for of in (off, ratio)
        )
        middle = median.value, median.uncertainty
        slope, allowed = None, self.entries[id].get("tolerance_exponent")
        if allowed is not None:
            logs = [np.log(each) for each in numbers]
            found = self.studied(tables, [exponent(each) for each in logs])
            columns = [tables[0][name].to_numpy() for name in levels]
            without = [
                exponent(logs[0][:, of != level]) for of in columns for level in np.unique(of)
            ]
            moved = max((abs(other - found.value) for other in without), default=0.0)
            slope = found.value, max(found.uncertainty, moved)
            claim |= {"exponent": slope[0], "exponent_uncertainty": slope[1]}

        def at(tolerance: float) -> str:
            return rules.approximate(middle, tolerance, slope, float(allowed or 0.0))

        return claim | {
            "verdict": at(self.tolerance(id)), "at": at, "predicted": 1.0, "measured": shown.value,
            "uncertainty": shown.uncertainty, "deviation": median.value,
            "ninety": float(each.quantile(0.9)), "largest": float(each.max()),
        }  # fmt: skip

    def qualitative(self, decided: Iterable[bool | None], condition: bool = False) -> Claim:
        """An always, never or every, by whether it holds in each run, None where that is undecided."""
        decided = list(decided)
        runs, undecided = len(decided), sum(found is None for found in decided)
        held = sum(bool(found) for found in decided)
        failed = runs - undecided - held
        return {
            "verdict": rules.qualitative(held, failed, undecided, condition), "predicted": runs,
            "measured": held, "uncertainty": undecided, "deviation": failed / runs if runs else NAN,
            "runs": runs, "held": held, "failed": failed, "undecided": undecided,
        }  # fmt: skip

    def agreed(
        self, simulation: str, where: str, holds: str, told: str = "", ends: Sequence[str] = ()
    ) -> list[bool | None]:
        """Whether it holds in each run: by both finest lattices if long enough (``told``), else by its exact regime."""
        finest, middle, *_ = self.lattices(simulation, where=where)
        both = agreeing(evaluated(finest, holds), evaluated(middle, holds))
        exact = finest["exact_regime"] if ends else [UNDECIDED] * len(finest)
        return [
            found if seen and found is not None else None if end == UNDECIDED else end in ends
            for seen, found, end in zip(evaluated(finest, told), both, exact, strict=True)
        ]

    def compared(self, simulation: str, quantity: str) -> dict[str, float]:
        """Median and largest deviation of runs at spacing 0 from the exact theory."""
        table = self.lattices(simulation)[0]
        off = (ratios(table, f"extrapolated_{quantity}", f"exact_{quantity}") - 1.0).abs()
        off = off[np.isfinite(off)]
        return (
            {"exact_median": float(off.median()), "exact_largest": float(off.max())}
            if off.size
            else {}
        )
