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
    """Sort tests by the order of files in `FIRST`; within a file the order stays."""

    def position(item: pytest.Item) -> int:
        stem = item.path.stem
        return FIRST.index(stem) if stem in FIRST else len(FIRST)

    items.sort(key=position)


@pytest.fixture(scope="session")
def project() -> Path:
    """Return the folder of the project."""
    return Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def shipped(project: Path) -> dict:
    """Return the shipped configuration, which tests must not change."""
    return yaml.safe_load((project / "config/config.yaml").read_text(encoding="utf-8"))


@pytest.fixture
def config(shipped: dict) -> dict:
    """Return a copy of the shipped configuration, which a test may change."""
    return copy.deepcopy(shipped)


@pytest.fixture(scope="session")
def paper_accuracy(shipped: dict) -> dict:
    """Return the step and the order of the preset paper."""
    return {key: shipped["presets"]["paper"][key] for key in ("max_step", "order")}


@pytest.fixture(scope="session")
def shared(tmp_path_factory, worker_id) -> Path:
    """Return a folder that all workers share, so that one reads the files of another."""
    folder = tmp_path_factory.getbasetemp()
    # Each worker has its own folder inside the folder of the session.
    session_folder = folder if worker_id == "master" else folder.parent
    return session_folder / "shared"


@pytest.fixture(scope="session")
def study(project, shipped, shared):
    """Return a function that runs a small study with the shipped settings and returns its table."""

    def run(name: str, data: dict | None = None, tables: dict | None = None):
        path = shared / f"studies/{name}.csv"
        # The other worker may be running the same study.
        with take(path.with_suffix(".lock"), wait=True):
            if not path.exists():
                needs = declared(f"studies.{name}", "NEEDS")
                lists = [project / path for path in needs.get("lists", [])]
                all_tables = (tables or {}) | load_inputs({"lists": lists}).tables
                settings = small_settings(shipped, needs)
                save_table(small_table(name, data or {}, all_tables, settings), path)
        return load_table(path)

    return run


def small_settings(shipped: dict, needs: dict) -> dict:
    """Return the settings of a study, with small sweeps."""
    sweeps = {name: small_sweep(shipped, name) for name in needs.get("sweeps", ())}
    settings = selected(shipped, needs.get("settings", ()), {})
    return settings | {"sweeps": sweeps} if sweeps else settings


def small_table(name: str, data: dict, tables: dict, settings: dict):
    """Return the table of a study whose lists of cases are shortened."""
    module = import_module(f"slippulse_paper.studies.{name}")
    with pytest.MonkeyPatch.context() as patch:
        for constant, value in SMALL_STUDIES.get(name, {}).items():
            patch.setattr(module, constant, value)
        return module.table(data, tables, settings)
