"""Every figure drawn from small, really simulated data, through the CSV as the pipeline does it."""

from __future__ import annotations

import copy
from importlib import import_module
from types import SimpleNamespace

import pytest
import yaml

from slippulse.configuration.expand import expand, resolve
from slippulse.data.store import load_table, save_table
from slippulse.measure.table import measure
from slippulse.simulation.sweep import run_sweep

# A few points of each list are enough to draw.
THIN = {"left": 4, "gamma": 4, "width": 3, "damping_ratio": 3, "dx": 3}
INPUTS = {
    "fig01_system_sketch": [],
    "fig02_phase_diagram": ["regimes_displacement", "regimes_stress", "regimes_beyond"],
    "fig03_steady_state": ["steady_displacement", "steady_stress"],
    "fig04_space_time": ["space_time_displacement", "space_time_stress"],
    "fig05_scaling": ["scaling_displacement", "scaling_stress"],
    "fig06_burridge_knopoff": ["burridge_knopoff_displacement", "burridge_knopoff_stress"],
    "fig07_damage_zone": [],
    "fig08_steady_state_displacement": ["steady_displacement"],
    "fig09_steady_state_stress": ["steady_stress"],
    "fig10_damping_displacement": ["damping_displacement"],
    "fig11_damping_stress": ["damping_stress"],
    "study_front_speed": ["front_speed", "front_speed_slow"],
    "study_pulse_theory": ["pulse_damping"],
    "study_continuum_limit": ["continuum_fixed_ratio", "continuum_fixed_beta"],
    "study_exact_transition": ["scaling_displacement", "scaling_stress", "transition_convergence"],
    "study_arrest": ["arrest"],
    "study_stability_of_pulses": ["pulses_across_a_step", "regimes_beyond"],
    "study_extremes": [],
    "study_stability": [],
    "study_accuracy_cost": [],
}
# Studies of the solver, whose tables come from runs of their own.
TABLES = {
    "study_extremes": ["extremes"],
    "study_stability": ["stability"],
    "study_accuracy_cost": ["accuracy_cost"],
}


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

    def simulate(name: str):
        if name not in simulated:
            block = copy.deepcopy(config["simulations"][name])
            if not name.startswith("regimes"):
                for key, count in THIN.items():
                    if key in block:
                        block[key] = thinned(block[key], count)
            block = resolve(block, config["model"], config["presets"]["draft"])
            scenes, samples = expand(block)
            sweep = run_sweep(scenes, samples, block["record"], threads=2)
            save_table(measure(sweep, config["measure"]), folder / f"{name}.csv")
            simulated[name] = (sweep, load_table(folder / f"{name}.csv"))
        return simulated[name]

    def figure(name: str) -> SimpleNamespace:
        if name not in drawn:
            module = import_module(f"slippulse.figures.{name}")
            inputs = {source: simulate(source) for source in INPUTS[name]}
            settings = {
                "measure": config["measure"],
                "paper_damping_ratio": config["model"]["damping_ratio"],
                **config["figures"].get(name, {}),
            }
            data = {source: pair[0] for source, pair in inputs.items()}
            measured = {source: pair[1] for source, pair in inputs.items()}
            measured |= {source: study(source) for source in TABLES.get(name, [])}
            save_table(module.table(data, measured, settings), folder / f"{name}.csv")
            table = load_table(folder / f"{name}.csv")
            drawn[name] = SimpleNamespace(
                table=table,
                figure=module.plot(table),
                data=data,
                measured=measured,
                settings=settings,
                module=module,
            )
        return drawn[name]

    return figure


@pytest.fixture(scope="session")
def names() -> list[str]:
    """Every figure."""
    return list(INPUTS)
