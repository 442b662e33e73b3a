"""Every figure drawn from small, really simulated data, through the CSV as the pipeline does it."""

from importlib import import_module
from types import SimpleNamespace

import pandas as pd
import pytest
from selection import small_sweep

from slippulse.configuration.expand import expand
from slippulse.data.store import load_dataset, save_dataset
from slippulse.data.tables import load_table, save_table
from slippulse.predict.comparison import measured_table
from slippulse.simulation.simulate import run_sweep
from slippulse.steps.predict import predictions
from slippulse.steps.reach import declared
from slippulse.steps.targets import selected

# A claim that a choice decides, and one without a choice, as in claims.json.
CLAIMS = [
    {"id": "estimate", "label": "an estimate", "kind": "approximate",
     "verdict": "depends on an open choice", "tolerance": 0.2, "choice": "release", "deviation": 0.24, "choices": [
         {"release": "total", "deviation": 0.24, "solution": "lattice"},
         {"release": "elastic", "deviation": 0.16, "solution": "exact"}]},
    {"id": "equation", "label": "an equation", "kind": "exact", "verdict": "reproduced", "tolerance": 0.01,
     "choice": "", "deviation": 1e-9, "choices": []},
    {"id": "position", "label": "a position", "kind": "approximate", "verdict": "reproduced", "tolerance": 0.2,
     "choice": "damping_ratio", "deviation": 0.01, "choices": [
         {"release": "total", "deviation": 0.04, "solution": "lattice"}]},
]  # fmt: skip


@pytest.fixture(scope="session")
def draw(shipped, shared, tmp_path_factory, study):
    """A function that draws a figure by name and returns its table, its Figure and what it was drawn from."""
    folder = tmp_path_factory.mktemp("tables")
    simulated, drawn = {}, {}

    def simulate(name: str):
        if name not in simulated:
            block = small_sweep(shipped, name)
            files = [shared / f"sweeps/{name}.{ending}" for ending in ("nc", "csv")]
            scenes, samples = expand(block)
            if not files[1].exists():
                save_dataset(run_sweep(scenes, samples, block["record"], threads=2), files[0])
                save_table(measured_table(load_dataset(files[0]), shipped["measure"]), files[1])
            simulated[name] = (load_dataset(files[0]), load_table(files[1]), scenes)
        return simulated[name]

    def inputs(needs: dict) -> tuple[dict, dict]:
        """Data and tables, as the workflow joins them."""
        data = {source: simulate(source)[0] for source in needs.get("data", [])}
        tables = {source: simulate(source)[1] for source in needs.get("measured", [])}
        for source, topics in needs.get("predicted", {}).items():
            path = shared / f"sweeps/{source}.{'_'.join(topics)}.csv"
            if not path.exists():
                save_table(predictions(topics, simulate(source)[2], shipped["measure"]), path)
            predicted = load_table(path)
            tables[source] = tables[source].join(predicted) if source in tables else predicted
        for source in needs.get("studies", []):
            tables[source] = study(source, *inputs(declared(f"studies.{source}", "NEEDS")))
        if "lists" in needs:
            tables["claims"] = pd.DataFrame(CLAIMS)
        return data, tables

    def drawn_by(name: str) -> SimpleNamespace:
        if name not in drawn:
            module = import_module(f"slippulse.figures.{name}")
            needs = declared(f"figures.{name}", "NEEDS")
            settings = selected(
                shipped, needs.get("settings", ()), shipped["figures"].get(name, {})
            )
            data, tables = inputs(needs)
            save_table(module.table(data, tables, settings), folder / f"{name}.csv")
            table = load_table(folder / f"{name}.csv")
            figure = module.plot(table)
            drawn[name] = SimpleNamespace(
                table=table, figure=figure, measured=tables, module=module
            )
        return drawn[name]

    return drawn_by
