"""Every figure drawn from small, really simulated data, through the CSV as the pipeline does it."""

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest
from selection import small_sweep

from slippulse.configuration.expand import expand
from slippulse.configuration.runs import runs
from slippulse.data.saving import save_dataset
from slippulse.data.store import load_dataset
from slippulse.data.tables import load_table, save_table
from slippulse.figures.style import house_style
from slippulse.predict.comparison import measured_table
from slippulse.simulation.simulate import run_sweep
from slippulse.steps.predict import predictions
from slippulse.steps.reach import declared
from slippulse.steps.targets import selected


def claim(name, verdict, tolerance, deviation, choice="", choices=()) -> dict:
    one = {"id": name, "label": f"an {name}", "kind": "approximate" if choice else "exact"}
    one |= {"verdict": verdict, "tolerance": tolerance, "deviation": deviation}
    return one | {"choice": choice, "choices": list(choices)}


LATTICE = {"release": "total", "deviation": 0.24, "solution": "lattice"}
EXACT = {"release": "elastic", "deviation": 0.16, "solution": "exact"}
CLAIMS = [
    claim("estimate", "depends on an open choice", 0.2, 0.24, "release", [LATTICE, EXACT]),
    claim("equation", "reproduced", 0.01, 1e-9),
    claim("extent", "reproduced", 0.2, 0.01, "damping_ratio", [LATTICE | {"deviation": 0.04}]),
]


class Drawings:
    """Figures drawn by name, each once, and the small sweeps that they show."""

    def __init__(self, shipped: dict, shared: Path, folder: Path, study: Callable):
        self.shipped, self.shared, self.folder, self.study = shipped, shared, folder, study
        self.simulated: dict[str, tuple] = {}
        self.drawn: dict[str, SimpleNamespace] = {}

    def simulate(self, name: str) -> tuple:
        if name not in self.simulated:
            block = small_sweep(self.shipped, name)
            data, measured = (self.shared / f"sweeps/{name}.{ending}" for ending in ("nc", "csv"))
            scenes, samples = expand(block)
            if not measured.exists():
                save_dataset(run_sweep(scenes, samples, block["record"], threads=2), data)
                save_table(measured_table(load_dataset(data), self.shipped["measure"]), measured)
            self.simulated[name] = (load_dataset(data), load_table(measured))
        return self.simulated[name]

    def predict(self, name: str, topics: list[str]) -> pd.DataFrame:
        path = self.shared / f"sweeps/{name}.{'_'.join(topics)}.csv"
        if not path.exists():
            swept = [*runs(small_sweep(self.shipped, name))]
            save_table(predictions(topics, swept, self.shipped["measure"]), path)
        return load_table(path)

    def inputs(self, needs: dict) -> tuple[dict, dict]:
        """Data and tables, as the workflow joins them."""
        data = {name: self.simulate(name)[0] for name in needs.get("data", [])}
        tables = {}
        for name, topics in needs.get("measured", {}).items():
            measured = self.simulate(name)[1]
            tables[name] = measured.join(self.predict(name, topics)) if topics else measured
        for name in needs.get("studies", []):
            tables[name] = self.study(name, *self.inputs(declared(f"studies.{name}", "NEEDS")))
        if "lists" in needs:
            tables["claims"] = pd.DataFrame(CLAIMS)
        return data, tables

    def draw(self, name: str) -> SimpleNamespace:
        """Table and Figure, what they were drawn from, and the module."""
        if name not in self.drawn:
            module = import_module(f"slippulse.figures.{name}")
            needs = declared(f"figures.{name}", "NEEDS")
            options = self.shipped["figures"].get(name, {})
            settings = selected(self.shipped, needs.get("settings", ()), options)
            data, tables = self.inputs(needs)
            save_table(module.table(data, tables, settings), self.folder / f"{name}.csv")
            table = load_table(self.folder / f"{name}.csv")
            figure = module.draw(table)
            parts = {"table": table, "figure": figure, "measured": tables, "module": module}
            self.drawn[name] = SimpleNamespace(**parts)
        return self.drawn[name]


@pytest.fixture(scope="module", autouse=True)
def in_house_style():
    with house_style():
        yield


@pytest.fixture(scope="session")
def draw(shipped, shared, tmp_path_factory, study):
    """Function that draws a figure by its name."""
    return Drawings(shipped, shared, tmp_path_factory.mktemp("tables"), study).draw
