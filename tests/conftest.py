"""What all tests share: the project's folders and its configuration."""

from __future__ import annotations

import copy
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest
import yaml

from slippulse.store import load_table, save_table

PROJECT = Path(__file__).resolve().parents[1]


# The files that take longest, first, so that two workers end together.
LONGEST = (
    "test_faults",
    "test_reruns",
    "test_examples",
    "test_every_figure",
    "test_pipeline",
    "test_rendering",
)


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compile the kernels once, before the workers start and each would."""
    if not hasattr(session.config, "workerinput") and not session.config.option.collectonly:
        program = "from slippulse.lattice.compilation import compile_all; compile_all()"
        subprocess.run([sys.executable, "-c", program], check=True)


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Long files first; within a file the order stays."""
    items.sort(key=lambda item: LONGEST.index(item.path.stem) if item.path.stem in LONGEST else len(LONGEST))


@pytest.fixture(scope="session")
def project() -> Path:
    """The folder of the project."""
    return PROJECT


@pytest.fixture
def config(project: Path) -> dict:
    """The shipped configuration, a fresh copy."""
    return copy.deepcopy(yaml.safe_load((project / "config/config.yaml").read_text(encoding="utf-8")))


@pytest.fixture(scope="session")
def paper_accuracy() -> dict:
    """Order and step of the preset "paper"."""
    config = yaml.safe_load((PROJECT / "config/config.yaml").read_text(encoding="utf-8"))
    return {key: config["presets"]["paper"][key] for key in ("max_step", "order")}


@pytest.fixture(scope="session")
def study(project, tmp_path_factory):
    """A function that runs a study with the shipped settings and returns its table, through the CSV."""
    config = yaml.safe_load((project / "config/config.yaml").read_text(encoding="utf-8"))
    folder = tmp_path_factory.mktemp("studies")
    done = {}

    def run(name: str):
        if name not in done:
            settings = config["studies"][name] | {
                "front_window": config["measure"]["front_window"],
                "presets": config["presets"],
            }
            table = import_module(f"slippulse.studies.{name}").table(settings)
            save_table(table, folder / f"{name}.csv")
            done[name] = load_table(folder / f"{name}.csv")
        return done[name]

    return run
