"""Fixtures of all tests: the folders of the project, its configuration, and compiled kernels."""

import copy
import os
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
import yaml
from selection import SMALL_STUDIES, small_sweep

from slippulse.data.tables import load_table, save_table
from slippulse_paper.configuration.selected import selected
from slippulse_paper.records.lock import take
from slippulse_paper.steps.inputs import load_inputs
from slippulse_paper.steps.needs import declared

# Two workers share two cores.
os.environ.setdefault("OMP_NUM_THREADS", "1")

# The first files run no kernel, while the kernels are compiled. Then come those that take longest,
# so that the workers end together, and those whose studies others read.
FIRST = ("test_final_regime", "test_refused_commands", "test_refusals", "test_dependencies")
FIRST += ("test_plans", "test_studies", "test_every_figure", "test_faults")
COMPILE = "from slippulse.solver.compilation import compile_all; compile_all()"


def pytest_sessionstart(session: pytest.Session) -> None:
    """Begin to compile the kernels, unless they are in the user's cache, before workers start."""
    config = session.config
    if getattr(config.option, "numprocesses", None) and not hasattr(config, "workerinput"):
        config.add_cleanup(subprocess.Popen([sys.executable, "-c", COMPILE]).wait)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Sort tests by the order of files above; within a file the order stays."""
    place = {stem: number for number, stem in enumerate(FIRST)}
    items.sort(key=lambda item: place.get(item.path.stem, len(FIRST)))


@pytest.fixture(scope="session")
def project() -> Path:
    return Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def shipped(project: Path) -> dict:
    """The shipped configuration, to be read only."""
    return yaml.safe_load((project / "config/config.yaml").read_text(encoding="utf-8"))


@pytest.fixture
def config(shipped: dict) -> dict:
    return copy.deepcopy(shipped)


@pytest.fixture(scope="session")
def paper_accuracy(shipped: dict) -> dict:
    return {key: shipped["presets"]["paper"][key] for key in ("max_step", "order")}


@pytest.fixture(scope="session")
def shared(tmp_path_factory, worker_id) -> Path:
    """A folder in which workers read files that another has written."""
    folder = tmp_path_factory.getbasetemp()
    # The folder of a worker is in that of the session.
    return (folder if worker_id == "master" else folder.parent) / "shared"


@pytest.fixture(scope="session")
def study(project, shipped, shared):
    """A function that runs a small study with the shipped settings and returns its table."""

    def run(name: str, data: dict | None = None, tables: dict | None = None):
        path = shared / f"studies/{name}.csv"
        # The other worker may be at work on it.
        with take(path.with_suffix(".lock"), wait=True):
            if not path.exists():
                needs = declared(f"studies.{name}", "NEEDS")
                settings = selected(shipped, needs.get("settings", ()), {})
                sweeps = {sweep: small_sweep(shipped, sweep) for sweep in needs.get("sweeps", ())}
                settings |= {"sweeps": sweeps} if sweeps else {}
                module = import_module(f"slippulse_paper.studies.{name}")
                lists = load_inputs(
                    {"lists": [project / listed for listed in needs.get("lists", [])]}
                ).tables
                with pytest.MonkeyPatch.context() as patch:
                    for constant, value in SMALL_STUDIES.get(name, {}).items():
                        patch.setattr(module, constant, value)
                    save_table(module.table(data or {}, (tables or {}) | lists, settings), path)
        return load_table(path)

    return run
