"""Provide the result tables to the functions that judge claims, and build claims from them.

`Evidence` holds all tables and selects runs on three lattices of different spacing. Its methods
make claims of the measured kinds. The functions before it evaluate expressions over columns and
estimate grid uncertainties.
"""

import re
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
    """Evaluate an expression over columns (`pandas.DataFrame.eval`)."""
    # Evaluation slows down with every column of the table, even if the expression does not use it.
    mentioned = [name for name in table if name in expression]
    return table[mentioned].eval(expression, engine="python")


def evaluated(table: pd.DataFrame, expression: str) -> np.ndarray:
    """Return the value of an expression over columns for each run; all True if it is empty."""
    if not expression:
        return np.ones(len(table), dtype=bool)
    # Most expressions are the name of one column, and a look-up is faster than an evaluation.
    value = table[expression] if expression in table else value_of(table, expression)
    return np.broadcast_to(np.asarray(value), len(table))


def ratios(table: pd.DataFrame, measured: str, predicted: str) -> pd.Series:
    """Return measured divided by predicted for each run, both given as expressions over columns.

    The ratio is NaN where a value is missing.
    """
    ratio = evaluated(table, measured) / evaluated(table, predicted)
    return pd.Series(ratio, table.index, float)


def agreed_answers(first: Iterable, second: Iterable) -> list[bool | None]:
    """Return the common answer of two lattices for each run.

    The answer is None if the lattices differ, or if they have no answer.
    """
    answers: list[bool | None] = []
    for on_first, on_second in zip(first, second, strict=True):
        agree = on_first is not None and on_first == on_second
        answers.append(bool(on_first) if agree else None)
    return answers


def with_grid_uncertainty(tables: Lattices, values: Sequence[float]) -> Uncertain:
    """Return a value and its grid uncertainty, from one value for each lattice.

    ``values`` begins with that of the finest lattice. The uncertainty of an exact solution, which
    is a single table, is 0.
    """
    if len(tables) == 1:
        return values[0], 0.0
    if tables[0].empty:
        return values[0], NAN
    # Spacings of the coarser lattices, divided by that of the finest.
    factors = [float(table["factor"].dropna().iloc[0]) for table in tables[1:]]
    study = grid_study(values, factors)
    return study.value, study.uncertainty


def _slope(logs: np.ndarray) -> float:
    """Return the slope of log(measured) as a function of log(predicted); NaN below 3 runs.

    ``logs`` has the shape [predicted and measured, run].
    """
    x, y = logs[:, np.isfinite(logs).all(axis=0)]
    return fit_line(x, y).slope if x.size > 2 else NAN


def exponent(tables: Lattices, measured: str, predicted: str, columns: Iterable[str]) -> Uncertain:
    """Return the exponent of ``measured`` as a power of ``predicted``, with its uncertainty.

    The uncertainty includes how much the exponent changes if all runs that share a value of one of
    ``columns`` are left out.
    """
    logs = []
    for table in tables:
        pair = evaluated(table, predicted), evaluated(table, measured)
        logs.append(np.log(np.array(pair, dtype=float)))
    value, uncertainty = with_grid_uncertainty(tables, [_slope(pair) for pair in logs])

    for name in columns:
        column = tables[0][name].to_numpy()
        for left_out in np.unique(column):
            change = abs(_slope(logs[0][:, column != left_out]) - value)
            uncertainty = max(uncertainty, change)
    return value, uncertainty


class Evidence:
    """All result tables by name: simulations, coarser/NAME, uncertainties/NAME, and studies."""

    def __init__(
        self, tables: Mapping[str, pd.DataFrame], entries: Texts, steady: float, readings: Texts
    ) -> None:
        self.tables = tables
        # Texts of the claims in manuscript/claims.yaml, by claim id.
        self.entries = entries
        # Largest velocity change of a steady pulse.
        self.steady = steady
        # Values that were read off the published figure.
        self.readings = readings
        coarser = [path for path in tables if path.startswith("coarser/")]
        self.swept = [path.removeprefix("coarser/") for path in coarser]
        self._lattices = {name: self._three_lattices(name) for name in self.swept}

    def _three_lattices(self, simulation: str) -> list[pd.DataFrame]:
        """Return the measured runs on three lattices, the finest first, without flagged runs."""
        finest, coarser = self.tables[simulation], self.tables[f"coarser/{simulation}"]
        # The grid study has one row for each run (point) and quantity. It becomes one row for each
        # run, with the columns extrapolated_QUANTITY and uncertainty_QUANTITY.
        grid_study_rows = self.tables[f"uncertainties/{simulation}"]
        by_run = grid_study_rows.set_index(["point", "quantity"])
        by_run = by_run[["extrapolated", "uncertainty"]].unstack()
        by_run.columns = ["_".join(column) for column in by_run.columns]
        tables = [finest.join(by_run)]
        # Predictions are the same on all lattices, and only the table of the finest has them.
        predictions = finest[finest.columns.difference(coarser.columns)]
        for _, lattice in coarser.groupby("factor"):
            tables.append(lattice.reset_index(drop=True).join(predictions))
        # If a run is flagged on the finest lattice, its numbers do not describe the model.
        has_no_flag = finest["run_flags"].isna() | (finest["run_flags"] == "")
        if has_no_flag.all():
            return tables
        return [table[has_no_flag] for table in tables]

    def assign(self, simulation: str, columns: Callable[[pd.DataFrame], dict]) -> None:
        """Add columns to the runs of a simulation, on each lattice.

        columns : function that computes the new columns, by name, from the table of a lattice
        """
        tables = self._lattices[simulation]
        self._lattices[simulation] = [table.assign(**columns(table)) for table in tables]

    def lattices(self, *simulations: str, where: str = "") -> list[pd.DataFrame]:
        """Return the runs of some simulations as three tables, the finest lattice first.

        where : condition over columns that selects runs, evaluated on the finest lattice
        """
        selected = []
        for name in simulations:
            tables = self._lattices[name]
            is_selected = evaluated(tables[0], where)
            selected.append([table[is_selected] for table in tables])
        # Lattices of the same rank belong together: all finest ones, then all coarser ones.
        return [pd.concat(tables_of_rank) for tables_of_rank in zip(*selected, strict=True)]

    def flags_behind(self, source: str) -> str:
        """Return a sentence on the flagged runs of the simulations in a source; empty if none is.

        Claims do not use a flagged run, so that such a run may leave a claim without a number.
        """
        parts = []
        for name in dict.fromkeys(re.findall(r"\w+", source)):
            if name not in self.swept:
                continue
            flags = self.tables[name]["run_flags"].dropna().astype(str)
            flags = flags[flags != ""]
            kinds = ", ".join(sorted({*",".join(flags).split(",")}))
            if len(flags):
                count = f"{len(flags)} of {len(self.tables[name])} runs of {name}"
                parts.append(f"{count} are flagged ({kinds}) and therefore not used")
        return f"{'; '.join(parts)}." if parts else ""

    def finest(self, *simulations: str, where: str = "") -> pd.DataFrame:
        """Return runs on the finest lattice.

        Columns extrapolated_QUANTITY and uncertainty_QUANTITY come from the grid study.
        """
        return self.lattices(*simulations, where=where)[0]

    def tolerance(self, id: str) -> float:
        """Return the tolerance of a claim."""
        return float(self.entries[id]["tolerance"])

    def equation(self, id: str, table: pd.DataFrame, quantity: str, predicted: str) -> Equation:
        """Compare the extrapolated values of a quantity with an expression that predicts them."""
        return Equation(
            tolerance=self.tolerance(id),
            predicted=evaluated(table, predicted).astype(float),
            measured=evaluated(table, f"extrapolated_{quantity}").astype(float),
            uncertainty=evaluated(table, f"uncertainty_{quantity}").astype(float),
        )

    def approximate(self, id: str, tables: Lattices, measured: str, predicted: str) -> Approximate:
        """Compare measured and predicted expressions in their medians over the runs.

        ``tables`` has one table for each lattice, or a single table of exact solutions.
        """
        # One series of all runs for each lattice.
        ratio_series = [ratios(table, measured, predicted) for table in tables]
        deviation_series = [(series - 1.0).abs() for series in ratio_series]
        median_ratios = [series.median() for series in ratio_series]
        median_deviations = [series.median() for series in deviation_series]
        return Approximate(
            tolerance=self.tolerance(id),
            deviations=deviation_series[0].to_numpy(),
            median=with_grid_uncertainty(tables, median_deviations),
            ratio=with_grid_uncertainty(tables, median_ratios),
        )

    def agreed(
        self, simulation: str, where: str, holds: str, decidable: str = "", ends: Sequence[str] = ()
    ) -> list[bool | None]:
        """Return for each run whether a condition holds; None if that is undecided.

        The two finest lattices decide if they agree and the run is decidable. Otherwise the exact
        regime decides, provided that ``ends`` lists the regimes in which the condition holds.
        """
        finest, middle, _ = self.lattices(simulation, where=where)
        answers = agreed_answers(evaluated(finest, holds), evaluated(middle, holds))
        is_decidable = evaluated(finest, decidable)
        exact_regimes = finest["exact_regime"] if ends else [UNDECIDED] * len(finest)
        decided: list[bool | None] = []
        for answer, lattices_decide, regime in zip(
            answers, is_decidable, exact_regimes, strict=True
        ):
            if lattices_decide and answer is not None:
                decided.append(answer)
            elif regime != UNDECIDED:
                decided.append(regime in ends)
            else:
                decided.append(None)
        return decided

    def deviation_from_exact(self, simulation: str, quantity: str) -> Uncertain:
        """Return the median and the largest deviation of a quantity from exact theory.

        The deviation of a run is |value/exact - 1|, with the value extrapolated to spacing 0.
        """
        table = self.finest(simulation)
        ratio = ratios(table, f"extrapolated_{quantity}", f"exact_{quantity}")
        deviation = (ratio - 1.0).abs()
        return float(deviation.median()), float(deviation.max())
