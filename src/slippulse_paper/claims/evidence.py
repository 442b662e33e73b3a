"""Provide all result tables to the functions that judge claims.

`Evidence` has the tables, and selects runs on three lattices of different spacing. Some of its
methods compare measured and predicted values. The functions of this module evaluate expressions
over columns, and estimate numerical uncertainties.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence

import numpy as np
import pandas as pd

from slippulse.measurement.front_paths import fit_line
from slippulse.measurement.regime import UNDECIDED
from slippulse.measurement.uncertainty import grid_study

from .kinds import NAN, Approximate, Equation
from .rules import Spread, Uncertain

Texts = Mapping[str, Mapping]
# Tables of the same runs, one for each lattice with the finest first, or one of exact solutions.
Lattices = Sequence[pd.DataFrame]


def value_of(table: pd.DataFrame, expression: str):
    """Evaluate an expression over the columns of a table (`pandas.DataFrame.eval`)."""
    # Every column of the table slows the evaluation down, even if the expression does not use it.
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
    """Return the ratio of a measured to a predicted value for each run; NaN if one is missing.

    measured, predicted : expressions over columns
    """
    ratio = evaluated(table, measured) / evaluated(table, predicted)
    return pd.Series(ratio, table.index, float)


def agreed_answers(finest: Iterable, coarser: Iterable) -> list[bool | None]:
    """Return for each run the answer on which two lattices agree; None if they differ or have none.

    finest, coarser : answers on each lattice, one for each run
    """
    answers: list[bool | None] = []
    for on_finest, on_coarser in zip(finest, coarser, strict=True):
        agree = on_finest is not None and on_finest == on_coarser
        answers.append(bool(on_finest) if agree else None)
    return answers


def with_grid_uncertainty(tables: Lattices, values: Sequence[float]) -> Uncertain:
    """Return a value on the finest lattice, and its uncertainty because of the finite spacing.

    The uncertainty is 0 for an exact solution, and NaN without runs.

    values : the value on each lattice, the finest first
    """
    # A single table is an exact solution.
    if len(tables) == 1:
        return Uncertain(values[0], 0.0)
    if tables[0].empty:
        return Uncertain(values[0], NAN)
    # Spacings of the coarser lattices, divided by that of the finest.
    factors = [float(table["factor"].dropna().iloc[0]) for table in tables[1:]]
    study = grid_study(values, factors)
    return Uncertain(study.value, study.uncertainty)


def _slope(logs: np.ndarray) -> float:
    """Return the slope of log(measured) as a function of log(predicted).

    NaN if fewer than 3 runs have both values.

    logs : array with a row for log(predicted), a row for log(measured), and a column for each run
    """
    has_both = np.isfinite(logs).all(axis=0)
    log_predicted, log_measured = logs[:, has_both]
    return fit_line(log_predicted, log_measured).slope if has_both.sum() > 2 else NAN


def fit_exponent(
    tables: Lattices, *, measured: str, predicted: str, varied_columns: Iterable[str]
) -> Uncertain:
    """Fit a measured quantity as a power of a predicted one, and return the exponent.

    The uncertainty of the exponent has two causes: the finite spacing, and the choice of runs. For
    the second, all runs with one value of one of the varied columns are left out, and the largest
    change of the exponent counts. The larger of both is returned.

    measured, predicted : expressions over columns
    """
    logs_by_lattice = []
    for table in tables:
        values = [evaluated(table, predicted), evaluated(table, measured)]
        logs_by_lattice.append(np.log(np.array(values, dtype=float)))
    slopes = [_slope(logs) for logs in logs_by_lattice]
    value, uncertainty = with_grid_uncertainty(tables, slopes)

    logs_on_finest = logs_by_lattice[0]
    for name in varied_columns:
        column = tables[0][name].to_numpy()
        for left_out in np.unique(column):
            slope_of_others = _slope(logs_on_finest[:, column != left_out])
            uncertainty = max(uncertainty, abs(slope_of_others - value))
    return Uncertain(value, uncertainty)


class Evidence:
    """All result tables, the texts of the claims, and the readings of the published figure.

    tables : tables by name. NAME has the runs of a simulation or the result of a study,
        coarser/NAME has the same runs on coarser lattices, and uncertainties/NAME has grid studies
    entries : entries of the claims in manuscript/claims.yaml, by claim id
    steady : largest relative change of velocity that a steady pulse may have
    readings : numbers that were read off the published figure, by name
    """

    def __init__(
        self, tables: Mapping[str, pd.DataFrame], entries: Texts, steady: float, readings: Texts
    ) -> None:
        """Keep the arguments, which are explained at the class, and prepare tables of lattices.

        There are three tables for each simulation that also ran on two coarser lattices. The table
        coarser/NAME has its coarser runs.
        """
        self.tables = tables
        self.entries = entries
        self.steady = steady
        self.readings = readings
        coarser = [path for path in tables if path.startswith("coarser/")]
        # Names of the simulations that have grid studies.
        self.swept = [path.removeprefix("coarser/") for path in coarser]
        self._lattices = {name: self._three_lattices(name) for name in self.swept}

    def _three_lattices(self, simulation: str) -> list[pd.DataFrame]:
        """Return the runs of a simulation on three lattices, the finest first.

        The table of the finest lattice also gets the results of the grid study, as the columns
        extrapolated_QUANTITY and uncertainty_QUANTITY. Runs that are flagged on the finest lattice
        are left out.
        """
        finest, coarser = self.tables[simulation], self.tables[f"coarser/{simulation}"]
        # The grid study has one row for each run (point) and quantity. Turn it into one row for
        # each run.
        by_run = self.tables[f"uncertainties/{simulation}"].pivot(
            index="point", columns="quantity", values=["extrapolated", "uncertainty"]
        )
        by_run.columns = [f"{number}_{quantity}" for number, quantity in by_run.columns]
        tables = [finest.join(by_run)]
        # Predictions are the same on all lattices, but only the table of the finest has them.
        predictions = finest[finest.columns.difference(coarser.columns)]
        # The column factor has the block spacing divided by that of the finest lattice.
        for _, runs_of_lattice in coarser.groupby("factor"):
            tables.append(runs_of_lattice.reset_index(drop=True).join(predictions))
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
        # Combine the finest lattices of all simulations, then the next coarser ones, and so on.
        return [pd.concat(tables_of_rank) for tables_of_rank in zip(*selected, strict=True)]

    def sentence_on_flags(self, source: str) -> str:
        """Return a sentence on flagged runs, which claims do not use; empty if there is none.

        source : text that contains names of simulations; its other words have no influence
        """
        parts = []
        words = dict.fromkeys(re.findall(r"\w+", source))
        for name in words:
            if name not in self.swept:
                continue
            all_runs = self.tables[name]
            flags_of_runs = all_runs["run_flags"].dropna().astype(str)
            flags_of_runs = flags_of_runs[flags_of_runs != ""]
            if len(flags_of_runs):
                # A run may have several flags, with commas between them.
                flags = ", ".join(sorted(flags_of_runs.str.split(",").explode().unique()))
                count = f"{len(flags_of_runs)} of {len(all_runs)} runs of {name}"
                parts.append(f"{count} are flagged ({flags}) and therefore not used")
        return f"{'; '.join(parts)}." if parts else ""

    def finest(self, *simulations: str, where: str = "") -> pd.DataFrame:
        """Return the runs of some simulations on the finest lattice, without flagged runs.

        The columns extrapolated_QUANTITY and uncertainty_QUANTITY come from the grid study.

        where : condition over columns that selects runs
        """
        return self.lattices(*simulations, where=where)[0]

    def tolerance(self, id: str) -> float:
        """Return the tolerance of the claim with this id."""
        return float(self.entries[id]["tolerance"])

    def equation(self, id: str, table: pd.DataFrame, quantity: str, predicted: str) -> Equation:
        """Compare a quantity, extrapolated to spacing 0, with its predicted value in each run.

        id : id of the claim
        predicted : expression over columns
        """
        return Equation(
            tolerance=self.tolerance(id),
            predicted=evaluated(table, predicted).astype(float),
            measured=evaluated(table, f"extrapolated_{quantity}").astype(float),
            uncertainty=evaluated(table, f"uncertainty_{quantity}").astype(float),
        )

    def approximate(self, id: str, tables: Lattices, measured: str, predicted: str) -> Approximate:
        """Compare a measured with a predicted value, in the median over all runs.

        id : id of the claim
        tables : one table for each lattice, the finest first, or a single table of exact solutions
        measured, predicted : expressions over columns
        """
        # One series for each lattice, with one value for each run.
        ratios_by_lattice = [ratios(table, measured, predicted) for table in tables]
        deviations_by_lattice = [(values - 1.0).abs() for values in ratios_by_lattice]
        median_ratios = [values.median() for values in ratios_by_lattice]
        median_deviations = [values.median() for values in deviations_by_lattice]
        return Approximate(
            tolerance=self.tolerance(id),
            deviations=deviations_by_lattice[0].to_numpy(),
            median=with_grid_uncertainty(tables, median_deviations),
            ratio=with_grid_uncertainty(tables, median_ratios),
        )

    def holds_in_runs(
        self, simulation: str, where: str, holds: str, decidable: str = "", ends: Sequence[str] = ()
    ) -> list[bool | None]:
        """Return for each run whether a condition holds; None if that is undecided.

        If the two finest lattices agree, they decide. If they disagree or cannot decide,
        the regime of the exact solution decides, provided that ``ends`` is given and that this
        regime is known.

        where : condition over columns that selects runs
        holds : the condition over columns that is judged
        decidable : condition over columns under which lattices can decide; always if it is empty
        ends : exact regimes in which the judged condition holds
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

    def deviation_from_exact(self, simulation: str, quantity: str) -> Spread:
        """Return the median and the largest deviation of a quantity from exact theory.

        The deviation of a run is |value/exact - 1|, with the value extrapolated to spacing 0.
        """
        table = self.finest(simulation)
        ratio = ratios(table, f"extrapolated_{quantity}", f"exact_{quantity}")
        deviation = (ratio - 1.0).abs()
        return Spread(median=float(deviation.median()), largest=float(deviation.max()))
