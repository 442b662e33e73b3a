"""Every figure drawn from small, really simulated data, through the CSV as the pipeline does it."""

from __future__ import annotations

import copy
from importlib import import_module
from types import SimpleNamespace

import pytest
import yaml
from selection import selected

from slippulse.configuration.expand import expand, resolve
from slippulse.data.store import load_table, save_table
from slippulse.predict.measured import measured_table
from slippulse.predict.table import predictions
from slippulse.simulation.sweep import run_sweep
from slippulse.steps.reach import declared

# A few points of each list are enough to draw.
THIN = {"left": 4, "gamma": 4, "width": 3, "damping_ratio": 3, "dx": 3}


def thinned(values: list, count: int) -> list:
    """The first, the last and evenly between."""
    if len(values) <= count:
        return values
    step = (len(values) - 1) / (count - 1)
    return [values[round(i * step)] for i in range(count)]


@pytest.fixture(scope="session")
def draw(project, tmp_path_factory, study):
    """A function that draws a figure by name and returns its table, its Figure and what it was drawn from."""
    config = yaml.safe_load((project / "config/config.yaml").read_text(encoding="utf-8"))
    folder = tmp_path_factory.mktemp("tables")
    simulated, drawn = {}, {}

    def simulate(name: str, coarser: float = 1.0):
        if (name, coarser) not in simulated:
            block = copy.deepcopy(config["simulations"][name])
            if not name.startswith("regimes"):
                for key, count in THIN.items():
                    if key in block:
                        block[key] = thinned(block[key], count)
            block = resolve(block, config["model"], config["presets"]["draft"], coarser)
            scenes, samples = expand(block)
            sweep = run_sweep(scenes, samples, block["record"], threads=2)
            save_table(measured_table(sweep, config["measure"]), folder / f"{name}.csv")
            save_table(predictions(scenes, config["measure"]["share"]), folder / f"{name}.predicted.csv")
            tables = load_table(folder / f"{name}.csv"), load_table(folder / f"{name}.predicted.csv")
            simulated[name, coarser] = (sweep, *tables)
        return simulated[name, coarser]

    def inputs(needs: dict) -> tuple[dict, dict]:
        """Data and tables, as the workflow joins them."""
        data = {source: simulate(source)[0] for source in needs.get("data", [])}
        tables = {source: simulate(source)[1] for source in needs.get("measured", [])}
        for source in needs.get("predicted", []):
            predicted = simulate(source)[2]
            tables[source] = tables[source].join(predicted) if source in tables else predicted
        for source in needs.get("studies", []):
            tables[source] = study(source, *inputs(declared(f"studies.{source}", "NEEDS")))
        factor = config["presets"]["draft"]["coarser"][0]
        for source in needs.get("coarser", []):
            tables[f"coarser/{source}"] = simulate(source, factor)[1].assign(factor=factor)
        return data, tables

    def figure(name: str) -> SimpleNamespace:
        if name not in drawn:
            module = import_module(f"slippulse.figures.{name}")
            needs = declared(f"figures.{name}", "NEEDS")
            settings = selected(config, needs.get("settings", ()), config["figures"].get(name, {}))
            data, tables = inputs(needs)
            save_table(module.table(data, tables, settings), folder / f"{name}.csv")
            table = load_table(folder / f"{name}.csv")
            drawn[name] = SimpleNamespace(
                table=table,
                figure=module.plot(table),
                data=data,
                measured=tables,
                settings=settings,
                module=module,
            )
        return drawn[name]

    return figure
