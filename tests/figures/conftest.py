"""Draw every figure from small simulated data, through the CSV file as in the workflow."""

from functools import cache
from importlib import import_module
from types import SimpleNamespace

import pandas as pd
import pytest
from selection import small_sweep

from slippulse.data.saving import save_dataset
from slippulse.data.store import load_dataset
from slippulse.data.tables import load_table, save_table
from slippulse.plotting.style import house_style
from slippulse.prediction.comparison import measured_table
from slippulse.simulation.simulate import run_sweep
from slippulse_paper.configuration.expand import expand
from slippulse_paper.configuration.runs import runs
from slippulse_paper.configuration.selected import selected
from slippulse_paper.steps.needs import declared
from slippulse_paper.steps.predict import predictions

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


def invented_uncertainties(sweeps: dict[str, pd.DataFrame]) -> dict[str, pd.DataFrame]:
    """Return grid studies in which time and length of the transition are uncertain by 1 %."""
    studies = {}
    for name, measured in sweeps.items():
        parts = []
        for quantity in ("transition_time", "transition_length"):
            rows = {
                "point": range(len(measured)),
                "uncertainty": 0.01 * measured[quantity].to_numpy(),
            }
            parts.append(pd.DataFrame(rows).assign(quantity=quantity))
        studies[f"uncertainties/{name}"] = pd.concat(parts, ignore_index=True)
    return studies


@pytest.fixture(scope="module", autouse=True)
def in_house_style():
    with house_style():
        yield


@pytest.fixture(scope="session")
def draw(shipped, shared, tmp_path_factory, study):
    """Return a function that draws a figure by its name, once, from small sweeps and studies."""
    folder = tmp_path_factory.mktemp("tables")

    @cache
    def simulate(name: str) -> tuple:
        block = small_sweep(shipped, name)
        data, measured = (shared / f"sweeps/{name}.{ending}" for ending in ("nc", "csv"))
        if not measured.exists():
            scenes, samples = expand(block)
            save_dataset(run_sweep(scenes, samples, block["record"], threads=2), data)
            save_table(measured_table(load_dataset(data), shipped["measure"]), measured)
        return load_dataset(data), load_table(measured)

    def predict(name: str, topics: list[str]) -> pd.DataFrame:
        path = shared / f"sweeps/{name}.{'_'.join(topics)}.csv"
        if not path.exists():
            swept = [*runs(small_sweep(shipped, name))]
            save_table(predictions(topics, swept, shipped["measure"]), path)
        return load_table(path)

    def inputs(needs: dict) -> tuple[dict, dict]:
        """Return data and tables, joined as in the workflow."""
        data = {name: simulate(name)[0] for name in needs.get("data", [])}
        tables = {}
        for name, topics in needs.get("measured", {}).items():
            measured = simulate(name)[1]
            tables[name] = measured.join(predict(name, topics)) if topics else measured
        uncertain = needs.get("uncertainties", [])
        tables |= invented_uncertainties({name: simulate(name)[1] for name in uncertain})
        for name in needs.get("studies", []):
            tables[name] = study(name, *inputs(declared(f"studies.{name}", "NEEDS")))
        if "lists" in needs:
            tables["claims"] = pd.DataFrame(CLAIMS)
        return data, tables

    @cache
    def drawn(name: str) -> SimpleNamespace:
        """Return the table and the Figure, the data behind them, and the module."""
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
