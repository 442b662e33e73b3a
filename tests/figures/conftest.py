"""Every figure drawn from small, really simulated data, through the CSV as the pipeline does it."""

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
    with house_style():
        yield


class SmallSweeps:
    """Small sweeps of the configuration, with their tables in a folder that workers share."""

    def __init__(self, config: dict, folder: Path) -> None:
        self.config, self.folder = config, folder

    def simulate(self, name: str) -> tuple[xr.Dataset, pd.DataFrame]:
        """Data and measured table of a sweep."""
        data, measured = (self.folder / f"{name}.{ending}" for ending in ("nc", "csv"))
        if not measured.exists():
            block = small_sweep(self.config, name)
            scenes, samples = expand(block)
            save_dataset(run_sweep(scenes, samples, block["record"], threads=2), data)
            save_table(measured_table(load_dataset(data), self.config["measure"]), measured)
        return load_dataset(data), load_table(measured)

    def predict(self, name: str, topics: list[str]) -> pd.DataFrame:
        """Predictions of a sweep."""
        path = self.folder / f"{name}.{'_'.join(topics)}.csv"
        if not path.exists():
            swept = [*runs(small_sweep(self.config, name))]
            save_table(predictions(topics, swept, self.config["measure"]), path)
        return load_table(path)

    def study_grid(self, name: str) -> pd.DataFrame:
        """Uncertainties of a sweep, from two coarser lattices."""
        path = self.folder / f"{name}.uncertainties.csv"
        if not path.exists():
            block, tables = small_sweep(self.config, name), [self.simulate(name)[1]]
            for factor in FACTORS:
                scenes, _ = expand(block | {"coarser": factor})
                coarse = run_sweep(scenes, record=["fronts"], threads=2)
                tables.append(measured_table(coarse, self.config["measure"]))
            save_table(grid_tables(tuple(tables), FACTORS, PARAMETERS), path)
        return load_table(path)


@pytest.fixture(scope="session")
def draw(shipped, shared, tmp_path_factory, study):
    """Function that draws a figure by its name, once, from small sweeps and studies."""
    folder = tmp_path_factory.mktemp("tables")
    sweeps = SmallSweeps(shipped, shared / "sweeps")
    simulate = cache(sweeps.simulate)

    def inputs(needs: dict) -> tuple[dict, dict]:
        """Data and tables, as the workflow joins them."""
        data = {name: simulate(name)[0] for name in needs.get("data", [])}
        tables = {}
        for name, topics in needs.get("measured", {}).items():
            measured = simulate(name)[1]
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
        """Table and Figure, what they were drawn from, and the module."""
        module = import_module(f"slippulse_paper.figures.{name}")
        needs = declared(f"figures.{name}", "NEEDS")
        options = shipped["figures"].get(name, {})
        data, tables = inputs(needs)
        values = selected(shipped, needs.get("settings", ()), options)
        save_table(module.table(data, tables, values), folder / f"{name}.csv")
        table = load_table(folder / f"{name}.csv")
        parts = {"table": table, "data": data, "measured": tables, "module": module}
        return SimpleNamespace(figure=module.draw(table), **parts)

    return drawn
