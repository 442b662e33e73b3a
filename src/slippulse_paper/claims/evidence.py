"""The tables that claims are computed from, and a claim of each measured kind from them."""

from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
import pandas as pd

from slippulse.measurement.front_paths import fit_line
from slippulse.measurement.regime import UNDECIDED
from slippulse.measurement.uncertainty import grid_study

from .kinds import NAN, Approximate, Equation
from .rules import Uncertain

Texts = Mapping[str, Mapping]
# A table for each lattice, the finest first, or one of exact solutions.
Lattices = Sequence[pd.DataFrame]


def value_of(table: pd.DataFrame, expression: str):
    """An expression over columns (`pandas.DataFrame.eval`)."""
    # Every column costs time, whether it is named or not.
    named = table[[name for name in table if name in expression]]
    return named.eval(expression, engine="python")


def evaluated(table: pd.DataFrame, expression: str) -> np.ndarray:
    """An expression over columns, of each run; true of every run if it is empty."""
    if not expression:
        return np.ones(len(table), dtype=bool)
    # Most expressions are one column, and looking it up takes the least time.
    value = table[expression] if expression in table else value_of(table, expression)
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


def studied(tables: Lattices, values: Sequence[float]) -> Uncertain:
    """A number computed from each table, with its uncertainty, which is 0 of an exact solution."""
    if len(tables) == 1:
        return values[0], 0.0
    if tables[0].empty:
        return values[0], NAN
    factors = [float(table["factor"].dropna().iloc[0]) for table in tables[1:]]
    study = grid_study(values, factors)
    return study.value, study.uncertainty


def _slope(logs: np.ndarray) -> float:
    """Slope of log measured over log predicted, [predicted and measured, run]; NaN below 3 runs."""
    x, y = logs[:, np.isfinite(logs).all(axis=0)]
    return fit_line(x, y).slope if x.size > 2 else NAN


def exponent(tables: Lattices, measured: str, predicted: str, columns: Iterable[str]) -> Uncertain:
    """The exponent of one expression over another, with its uncertainty."""
    logs = []
    for table in tables:
        pair = evaluated(table, predicted), evaluated(table, measured)
        logs.append(np.log(np.array(pair, dtype=float)))
    value, uncertainty = studied(tables, [_slope(pair) for pair in logs])
    # All runs with one value of a column, left out, may not change it by more.
    for name in columns:
        column = tables[0][name].to_numpy()
        for left_out in np.unique(column):
            change = abs(_slope(logs[0][:, column != left_out]) - value)
            uncertainty = max(uncertainty, change)
    return value, uncertainty


class Evidence:
    """Tables by name, of simulations (also coarser/NAME and uncertainties/NAME) and of studies."""

    def __init__(
        self, tables: Mapping[str, pd.DataFrame], entries: Texts, steady: float, readings: Texts
    ) -> None:
        self.tables, self.entries = tables, entries
        # The largest change of velocity of a steady pulse; what was read off the published figure.
        self.steady, self.readings = steady, readings
        coarser = [path for path in tables if path.startswith("coarser/")]
        self.swept = [path.removeprefix("coarser/") for path in coarser]
        self._lattices = {name: self._three_lattices(name) for name in self.swept}

    def _three_lattices(self, simulation: str) -> list[pd.DataFrame]:
        """The measured runs on three lattices, the finest first, without flagged runs."""
        finest, coarser = self.tables[simulation], self.tables[f"coarser/{simulation}"]
        study = self.tables[f"uncertainties/{simulation}"].set_index(["point", "quantity"])
        study = study[["extrapolated", "uncertainty"]].unstack()
        study.columns = ["_".join(column) for column in study.columns]
        predicted = finest[finest.columns.difference(coarser.columns)]
        parts = [part.reset_index(drop=True) for _, part in coarser.groupby("factor")]
        tables = [finest.join(study), *[part.join(predicted) for part in parts]]
        # The numbers of runs that are flagged on the finest lattice are not those of the model.
        kept = finest["run_flags"].isna() | (finest["run_flags"] == "")
        return tables if kept.all() else [table[kept] for table in tables]

    def assign(self, simulation: str, columns: Callable[[pd.DataFrame], dict]) -> None:
        """Add columns that are computed from the others on each lattice."""
        tables = self._lattices[simulation]
        self._lattices[simulation] = [table.assign(**columns(table)) for table in tables]

    def lattices(self, *simulations: str, where: str = "") -> list[pd.DataFrame]:
        """Runs on three lattices, of which a condition is true on the finest."""
        chosen = []
        for name in simulations:
            rows = evaluated(self._lattices[name][0], where)
            chosen.append([table[rows] for table in self._lattices[name]])
        return [pd.concat(parts) for parts in zip(*chosen, strict=True)]

    def finest(self, *simulations: str, where: str = "") -> pd.DataFrame:
        """Runs on the finest lattice, with extrapolated_QUANTITY and uncertainty_QUANTITY."""
        return self.lattices(*simulations, where=where)[0]

    def tolerance(self, id: str) -> float:
        """Tolerance of a claim."""
        return float(self.entries[id]["tolerance"])

    def equation(self, id: str, table: pd.DataFrame, quantity: str, predicted: str) -> Equation:
        """An equation, from the extrapolated values of a quantity and an expression for it."""
        return Equation(
            tolerance=self.tolerance(id),
            predicted=evaluated(table, predicted).astype(float),
            measured=evaluated(table, f"extrapolated_{quantity}").astype(float),
            uncertainty=evaluated(table, f"uncertainty_{quantity}").astype(float),
        )

    def approximate(self, id: str, tables: Lattices, measured: str, predicted: str) -> Approximate:
        """An estimate, from expressions over tables of lattices, or over one of exact solutions."""
        quotients = [ratios(table, measured, predicted) for table in tables]
        deviations = [(series - 1.0).abs() for series in quotients]
        return Approximate(
            tolerance=self.tolerance(id),
            deviations=deviations[0].to_numpy(),
            median=studied(tables, [series.median() for series in deviations]),
            ratio=studied(tables, [series.median() for series in quotients]),
        )

    def agreed(
        self, simulation: str, where: str, holds: str, decidable: str = "", ends: Sequence[str] = ()
    ) -> list[bool | None]:
        """Whether the two finest lattices, or else the exact regime, say that something holds."""
        finest, middle, _ = self.lattices(simulation, where=where)
        answers = agreeing(evaluated(finest, holds), evaluated(middle, holds))
        regimes = finest["exact_regime"] if ends else [UNDECIDED] * len(finest)
        decided: list[bool | None] = []
        tells = evaluated(finest, decidable)
        for answer, told, regime in zip(answers, tells, regimes, strict=True):
            by_theory = None if regime == UNDECIDED else regime in ends
            decided.append(answer if told and answer is not None else by_theory)
        return decided

    def deviation_from_exact(self, simulation: str, quantity: str) -> Uncertain:
        """Median and largest deviation of runs at spacing 0 from the exact theory."""
        table = self.finest(simulation)
        deviation = (ratios(table, f"extrapolated_{quantity}", f"exact_{quantity}") - 1.0).abs()
        return float(deviation.median()), float(deviation.max())
