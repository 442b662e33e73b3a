"""The tables that claims are computed from, and a claim of each measured kind from them."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace

import numpy as np
import pandas as pd

from ..measurement.fronts import straight_line
from ..measurement.regime import UNDECIDED
from ..measurement.uncertainty import grid_study
from .kinds import NAN, Approximate, Exact
from .rules import Known

Tables = Mapping[str, pd.DataFrame]
Texts = Mapping[str, Mapping]
# A table for each lattice, the finest first, or one of exact solutions.
Levels = Sequence[pd.DataFrame]


def evaluated(table: pd.DataFrame, expression: str) -> np.ndarray:
    """An expression over columns, of each run; true of every run if it is empty."""
    if not expression:
        return np.ones(len(table), dtype=bool)
    # Most expressions are one column, and looking it up takes the least time.
    if expression in table:
        return table[expression].to_numpy()
    # Every column costs time, whether it is named or not.
    named = table[[name for name in table if name in expression]]
    value = named.eval(expression, engine="python")
    return np.broadcast_to(np.asarray(value), len(table))


def ratios(table: pd.DataFrame, measured: str, predicted: str) -> pd.Series:
    """measured/predicted of each run, both expressions; NaN without a value."""
    return pd.Series(evaluated(table, measured) / evaluated(table, predicted), table.index, float)


def agreeing(first: Iterable, second: Iterable) -> list[bool | None]:
    """The answer in each run of two lattices; None where they differ or have none."""
    answers: list[bool | None] = []
    for one, other in zip(first, second, strict=True):
        answers.append(bool(one) if one is not None and one == other else None)
    return answers


def studied(tables: Levels, values: Sequence[float]) -> Known:
    """A number computed from each table, at the finest spacing, with its numerical uncertainty.

    With one table, the exact solution, the uncertainty is 0.
    """
    if len(tables) == 1 or tables[0].empty:
        return values[0], 0.0 if len(tables) == 1 else NAN
    factors = [float(table["factor"].dropna().iloc[0]) for table in tables[1:]]
    study = grid_study(values, factors)
    return study.value, study.uncertainty


def slope(logs: np.ndarray) -> float:
    """Slope of a straight line through two logarithms, [2, run]; NaN with fewer than three runs."""
    x, y = logs[:, np.isfinite(logs).all(axis=0)]
    return straight_line(x, y)[0] if x.size > 2 else NAN


def exponent(tables: Levels, measured: str, predicted: str, levels: Iterable[str]) -> Known:
    """The exponent of measured over predicted, expressions over tables, with its uncertainty.

    The uncertainty is at least the change when the runs at one value of a level are left out.
    """
    logs = []
    for table in tables:
        numbers = [evaluated(table, expression) for expression in (predicted, measured)]
        logs.append(np.log(np.array(numbers, float)))
    value, uncertainty = studied(tables, [slope(pair) for pair in logs])
    changes = []
    for name in levels:
        column = tables[0][name].to_numpy()
        for level in np.unique(column):
            changes.append(abs(slope(logs[0][:, column != level]) - value))
    return value, max(uncertainty, max(changes, default=0.0))


class Evidence:
    """All tables, with the texts of the claims and the readings of the published figure.

    There is a table for each simulation, with coarser/NAME and uncertainties/NAME of its grid
    study, and one for each study. Runs are chosen, and conditions on them stated, by expressions
    over columns (`pandas.DataFrame.eval`). ``steady`` is the change of the largest velocity below
    which a pulse is steady.
    """

    def __init__(
        self, tables: Tables, entries: Texts, steady: float, readings: Texts | None = None
    ) -> None:
        self.tables, self.entries = tables, entries
        self.steady, self.readings = steady, readings or {}
        coarser = [path for path in tables if path.startswith("coarser/")]
        self.swept = [path.removeprefix("coarser/") for path in coarser]
        self._lattices = {name: self._levels(name) for name in self.swept}

    def _levels(self, simulation: str) -> list[pd.DataFrame]:
        """The measured runs on three lattices, the finest first, without flagged runs."""
        finest, coarser = self.tables[simulation], self.tables[f"coarser/{simulation}"]
        study = self.tables[f"uncertainties/{simulation}"].set_index(["point", "quantity"])
        study = study[["extrapolated", "uncertainty"]].unstack()
        study.columns = ["_".join(column) for column in study.columns]
        predicted = finest[finest.columns.difference(coarser.columns)]
        parts = [part.reset_index(drop=True) for _, part in coarser.groupby("factor")]
        levels = [finest.join(study), *[part.join(predicted) for part in parts]]
        # The numbers of runs that are flagged on the finest lattice are not those of the model.
        kept = finest["run_flags"].isna() | (finest["run_flags"] == "")
        return [level[kept] for level in levels]

    def assign(
        self, simulation: str, columns: Callable[[pd.DataFrame], Mapping[str, pd.Series]]
    ) -> None:
        """Add columns that are computed from the others on each lattice."""
        levels = self._lattices[simulation]
        self._lattices[simulation] = [level.assign(**columns(level)) for level in levels]

    def lattices(self, *simulations: str, where: str = "") -> list[pd.DataFrame]:
        """Runs on three lattices.

        The finest has uncertainty_QUANTITY and extrapolated_QUANTITY too, at spacing 0.
        """
        parts = []
        for name in simulations:
            kept = evaluated(self._lattices[name][0], where)
            parts.append([level[kept] for level in self._lattices[name]])
        return [pd.concat(levels) for levels in zip(*parts, strict=True)]

    def finest(self, *simulations: str, where: str = "") -> pd.DataFrame:
        """Runs on the finest lattice, with extrapolated values and uncertainties."""
        return self.lattices(*simulations, where=where)[0]

    def tolerance(self, id: str) -> float:
        """Tolerance of a claim."""
        return float(self.entries[id]["tolerance"])

    def exact(self, id: str, table: pd.DataFrame, quantity: str, predicted: str) -> Exact:
        """An equation, from the extrapolated values of a quantity and an expression for it."""
        return Exact(
            tolerance=self.tolerance(id),
            predicted=evaluated(table, predicted).astype(float),
            measured=evaluated(table, f"extrapolated_{quantity}").astype(float),
            uncertainty=evaluated(table, f"uncertainty_{quantity}").astype(float),
        )

    def approximate(self, id: str, tables: Levels, measured: str, predicted: str) -> Approximate:
        """An estimate, from expressions over tables of lattices, or over one of exact solutions."""
        quotients = [ratios(table, measured, predicted) for table in tables]
        deviations = [(series - 1.0).abs() for series in quotients]
        finest = deviations[0][np.isfinite(deviations[0])].to_numpy()
        left_out = len(deviations[0]) - finest.size
        claim = Approximate(tolerance=self.tolerance(id), deviations=finest, left_out=left_out)
        if not finest.size:
            return claim
        median = studied(tables, [series.median() for series in deviations])
        ratio = studied(tables, [series.median() for series in quotients])
        return replace(claim, median=median, ratio=ratio)

    def agreed(
        self, simulation: str, where: str, holds: str, told: str = "", ends: Sequence[str] = ()
    ) -> list[bool | None]:
        """The answer in each run to whether something holds; None where it is undecided.

        The two finest lattices decide where they agree and the run is long enough (``told``).
        Else the exact regime decides, by whether it is one of ``ends``, if any are given.
        """
        finest, middle, _ = self.lattices(simulation, where=where)
        answers = agreeing(evaluated(finest, holds), evaluated(middle, holds))
        regimes = finest["exact_regime"] if ends else [UNDECIDED] * len(finest)
        decided: list[bool | None] = []
        for answer, seen, regime in zip(answers, evaluated(finest, told), regimes, strict=True):
            if seen and answer is not None:
                decided.append(answer)
            else:
                decided.append(None if regime == UNDECIDED else regime in ends)
        return decided

    def from_exact(self, simulation: str, quantity: str) -> Known | None:
        """Median and largest deviation of runs at spacing 0 from the exact theory."""
        table = self.finest(simulation)
        deviation = (ratios(table, f"extrapolated_{quantity}", f"exact_{quantity}") - 1.0).abs()
        deviation = deviation[np.isfinite(deviation)]
        return (float(deviation.median()), float(deviation.max())) if deviation.size else None
