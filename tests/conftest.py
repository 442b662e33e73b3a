"""What all tests share: the project's folders and its configuration."""

from __future__ import annotations

import copy
from pathlib import Path

import pytest
import yaml

PROJECT = Path(__file__).resolve().parents[1]


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
