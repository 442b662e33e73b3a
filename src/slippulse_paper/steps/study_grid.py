"""Run and measure one simulation on coarser lattices, for the uncertainty of each number."""

import sys
from pkgutil import resolve_name

import pandas as pd

from slippulse.data.sweeps import labelled
from slippulse.data.tables import load_table, save_table
from slippulse.measurement.promise import judge_promises, summarise_promises
from slippulse.measurement.table import LABELS, PARAMETERS
from slippulse.measurement.uncertainty import grid_tables
from slippulse.prediction.comparison import measured_table
from slippulse.simulation.sweep import solve_sweep

from ..configuration.expand import expand
from ..configuration.runs import profile_labels


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: finest. Outputs: uncertainties, coarser. Settings: solver, sweeps, measure."""
    name, sweeps = settings["simulation"], settings["sweeps"]
    solve = resolve_name(settings["solver"])
    tables = {}
    for factor in sorted(sweeps):
        sys.stderr.write(f"  {name}: {factor:g} times the spacing\n")
        sweep = sweeps[factor]
        scenes, samples = expand(sweep)
        data = solve_sweep(solve, scenes, samples, sweep["record"], settings["threads"])
        data = labelled(data, profile_labels(sweep), sweep["record"])
        tables[factor] = measured_table(data, settings["measure"])
    measured = load_table(files["finest"])
    if any("chunk" in sweep for sweep in sweeps.values()):
        # In one chunk a column of fractions may contain only integers. Read as integers, -0 would
        # lose its sign.
        fractions = measured.select_dtypes("integer").columns.difference([*PARAMETERS, *LABELS])
        measured = load_table(files["finest"], dict.fromkeys(fractions, float))
    keys = [*PARAMETERS, *(name for name in LABELS if name in measured)]
    uncertainties = grid_tables((measured, *tables.values()), tuple(tables), keys)
    promise = sweeps[min(sweeps)]["accuracy"].get("promise")
    if promise is not None:
        uncertainties = judge_promises(
            uncertainties, measured, promise, settings["measure"]["fraction"]
        )
        sys.stderr.write(f"  {name}: {summarise_promises(uncertainties, promise)}\n")
    save_table(uncertainties, outputs["uncertainties"])
    coarser = [table.assign(factor=factor) for factor, table in tables.items()]
    save_table(pd.concat(coarser, ignore_index=True), outputs["coarser"])
