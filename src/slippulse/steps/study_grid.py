"""Run and measure one simulation on coarser lattices, whose tables are kept, for the uncertainty of each number."""

import sys
from collections.abc import Callable
from functools import partial

import pandas as pd

from ..configuration.expand import expand, promise_of
from ..data.tables import load_table, save_table
from ..measure.promise import judged, summary
from ..measure.table import PARAMETERS
from ..measure.uncertainty import grid_tables
from ..predict.comparison import measured_table
from ..simulation.runs import run_all
from ..solver.run import run_scene


def study(solve: Callable, files: dict, outputs: dict, settings: dict) -> None:
    """Files: finest. Outputs: uncertainties, coarser. Settings: simulation, sweeps (by factor), measure, threads."""
    name, sweeps, measure = settings["simulation"], settings["sweeps"], settings["measure"]
    tables = {}
    for factor in sorted(sweeps):
        sys.stderr.write(f"  {name}: {factor:g} times the spacing\n")
        scenes, samples = expand(sweeps[factor])
        data = run_all(solve, scenes, samples, sweeps[factor]["record"], settings["threads"])
        tables[factor] = measured_table(data, measure)
    # A column of fractions may happen to have none in a chunk.
    part = any("chunk" in sweep for sweep in sweeps.values())
    measured = load_table(files["finest"], whole=PARAMETERS if part else None)
    found = grid_tables((measured, *tables.values()), tuple(tables), PARAMETERS)
    promise = promise_of(next(iter(sweeps.values())))
    if promise is not None:
        found = judged(found, measured, promise, measure["share"])
        sys.stderr.write(f"  {name}: {summary(found, promise)}\n")
    save_table(found, outputs["uncertainties"])
    coarser = [table.assign(factor=factor) for factor, table in tables.items()]
    save_table(pd.concat(coarser, ignore_index=True), outputs["coarser"])


run = partial(study, run_scene)
