"""Draw every figure from small simulations, through its CSV file as the workflow does."""

from functools import cache
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest
import xarray as xr
from selection import small_sweep

from slippulse.data.saving import save_dataset
from slippulse.data.store import load_dataset
from slippulse.data.tables import load_table, save_table
from slippulse.measurement.table import PARAMETERS
from slippulse.measurement.uncertainty import grid_tables
from slippulse.plotting.style import house_style
from slippulse.prediction.comparison import measured_table
from slippulse.simulation.simulate import run_sweep
from slippulse_paper.configuration.expand import expand
from slippulse_paper.configuration.runs import runs
from slippulse_paper.configuration.selected import selected
from slippulse_paper.steps.needs import declared
from slippulse_paper.steps.predict import predictions

# Factors of the spacing in grid studies.
FACTORS = (1.5, 2.0)
CHOICES = [
    {"release": "total", "deviation": 0.24, "solution": "lattice"},
    {"release": "elastic", "deviation": 0.16, "solution": "exact"},
]
CLAIMS = {
    "id": ["estimate", "equation", "extent"],
    "label": ["an estimate", "an equation", "an extent"],
    "kind": ["approximate", "exact", "approximate"],
    "verdict": ["depends on an open choice", "reproduced", "reproduced"],
    "tolerance": [0.2, 0.01, 0.2],
    "deviation": [0.24, 1e-9, 0.01],
    "choice": ["release", "", "damping_ratio"],
    "choices": [CHOICES, [], CHOICES[:1]],
}


@pytest.fixture(scope="module", autouse=True)
def in_house_style():
    """Draw all figures in the style of the project."""
    with house_style():
        yield


class SmallSweeps:
    """Small sweeps of the configuration, with their tables in a folder that workers share."""

    def __init__(self, config: dict, folder: Path) -> None:
        self.config, self.folder = config, folder

    def simulate(self, name: str) -> tuple[xr.Dataset, pd.DataFrame]:
        """Return the data and the measured table of a sweep."""
        data_path = self.folder / f"{name}.nc"
        measured_path = self.folder / f"{name}.csv"
        if not measured_path.exists():
            sweep = small_sweep(self.config, name)
            scenes, samples = expand(sweep)
            save_dataset(run_sweep(scenes, samples, sweep["record"], threads=2), data_path)
            measured = measured_table(load_dataset(data_path), self.config["measure"])
            save_table(measured, measured_path)
        return load_dataset(data_path), load_table(measured_path)

    def predict(self, name: str, topics: list[str]) -> pd.DataFrame:
        """Return the predictions for a sweep."""
        path = self.folder / f"{name}.{'_'.join(topics)}.csv"
        if not path.exists():
            swept = [*runs(small_sweep(self.config, name))]
            save_table(predictions(topics, swept, self.config["measure"]), path)
        return load_table(path)

    def study_grid(self, name: str) -> pd.DataFrame:
        """Return the uncertainties of a sweep, from two coarser lattices."""
        path = self.folder / f"{name}.uncertainties.csv"
        if not path.exists():
            sweep = small_sweep(self.config, name)
            _, measured = self.simulate(name)
            tables = [measured]
            for factor in FACTORS:
                scenes, _ = expand(sweep | {"coarser": factor})
                coarse = run_sweep(scenes, record=["fronts"], threads=2)
                tables.append(measured_table(coarse, self.config["measure"]))
            save_table(grid_tables(tuple(tables), FACTORS, PARAMETERS), path)
        return load_table(path)


@pytest.fixture(scope="session")
def draw(shipped, shared, tmp_path_factory, study):
    """Return a function that draws a figure by its name, once, from small sweeps and studies."""
    folder = tmp_path_factory.mktemp("tables")
    sweeps = SmallSweeps(shipped, shared / "sweeps")
    simulate = cache(sweeps.simulate)

    def inputs(needs: dict) -> tuple[dict, dict]:
        """Return data and tables, as the workflow joins them."""
        data, tables = {}, {}
        for name in needs.get("data", []):
            data[name], _ = simulate(name)
        for name, topics in needs.get("measured", {}).items():
            _, measured = simulate(name)
            tables[name] = measured.join(sweeps.predict(name, topics)) if topics else measured
        for name in needs.get("uncertainties", []):
            tables[f"uncertainties/{name}"] = sweeps.study_grid(name)
        for name in needs.get("studies", []):
            tables[name] = study(name, *inputs(declared(f"studies.{name}", "NEEDS")))
        if "lists" in needs:
            tables["claims"] = pd.DataFrame(CLAIMS)
        return data, tables

    @cache
    def drawn(name: str) -> SimpleNamespace:
        """Return the table and the Figure, what they were made from, and the module."""
        module = import_module(f"slippulse_paper.figures.{name}")
        needs = declared(f"figures.{name}", "NEEDS")
        data, tables = inputs(needs)
        options = shipped["figures"].get(name, {})
        values = selected(shipped, needs.get("settings", ()), options)
        path = folder / f"{name}.csv"
        save_table(module.table(data, tables, values), path)
        table = load_table(path)
        figure = module.draw(table)
        return SimpleNamespace(
            figure=figure, table=table, data=data, measured=tables, module=module
        )

    return drawn
