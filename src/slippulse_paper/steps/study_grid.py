"""Run and measure one simulation on coarser lattices to find the uncertainty of each number."""

import sys
from pkgutil import resolve_name

import pandas as pd

from slippulse.data.sweeps import with_run_labels
from slippulse.data.tables import load_table, save_table
from slippulse.measurement.promise import judge_promises, summarise_promises
from slippulse.measurement.table import LABELS, PARAMETERS, run_columns
from slippulse.measurement.uncertainty import grid_tables
from slippulse.prediction.comparison import measured_table
from slippulse.simulation.sweep import solve_sweep

from ..configuration.expand import expand
from ..configuration.runs import profile_labels


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the tables ``uncertainties`` and ``coarser`` of a simulation.

    The file ``finest`` has the measurements on the finest lattice. The settings have the solver,
    the settings of the measurements (``measure``), and the resolved simulation for each factor by
    which the spacing is larger (``sweeps``).
    """
    name, sweeps = settings["simulation"], settings["sweeps"]
    coarser_tables = {}
    for factor, sweep in sorted(sweeps.items()):
        sys.stderr.write(f"  {name}: solving on a lattice with {factor:g} times the spacing\n")
        coarser_tables[factor] = _run_and_measure(sweep, settings)
    # The sweeps differ only in their spacing.
    any_sweep = next(iter(sweeps.values()))
    measured = _load_measured(files["finest"], is_chunk="chunk" in any_sweep)
    tables = (measured, *coarser_tables.values())
    uncertainties = grid_tables(tables, tuple(coarser_tables), run_columns(measured.columns))
    # The relative accuracy that the user requires, if there is one.
    promise = any_sweep["accuracy"].get("promise")
    if promise is not None:
        # Under a stress boundary, this fraction of the left front's path defines the transition.
        fraction = settings["measure"]["fraction"]
        uncertainties = judge_promises(uncertainties, measured, promise, fraction)
        sys.stderr.write(f"  {name}: {summarise_promises(uncertainties, promise)}\n")
    save_table(uncertainties, outputs["uncertainties"])
    coarser = [table.assign(factor=factor) for factor, table in coarser_tables.items()]
    save_table(pd.concat(coarser, ignore_index=True), outputs["coarser"])


def _run_and_measure(sweep: dict, settings: dict) -> pd.DataFrame:
    """Solve the scenes of a resolved simulation, and return the table of measured numbers."""
    solve = resolve_name(settings["solver"])
    scenes, samples = expand(sweep)
    data = solve_sweep(solve, scenes, samples, record=sweep["record"], threads=settings["threads"])
    # Add the number and the seed of each run's profile, if the profiles are tables of pre-stress.
    data = with_run_labels(data, profile_labels(sweep), sweep["record"])
    return measured_table(data, settings["measure"])


def _load_measured(path: str, is_chunk: bool) -> pd.DataFrame:
    """Load the table of measured numbers of a simulation, or of one chunk of it."""
    measured = load_table(path)
    if not is_chunk:
        return measured
    # A column of floats may happen to have only whole numbers in one chunk, and is then read as
    # integers. It is read again as floats, because the integer -0 would lose its sign. Some
    # parameters and labels are integers in every table, and stay as they are.
    integer_columns = measured.select_dtypes("integer").columns
    measured_columns = integer_columns.difference([*PARAMETERS, *LABELS])
    return load_table(path, dict.fromkeys(measured_columns, float))
