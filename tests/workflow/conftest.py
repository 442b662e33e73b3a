"""Folders with results of imitated jobs, for tests that check which jobs run again."""

import shutil
from pathlib import Path

import pytest
import yaml
from pipeline_copy import OVERLAY, copy_project, imitate_steps, made

# Together these targets make all files. Some files of scenes are not part of everything.
TARGETS = ("everything", "scenes")
# Rules that only list targets.
TARGET_RULES = {"all", *TARGETS}
FIGURE = "results/figures/fig07_damage_zone.png"
# Targets for which most of the rules run.
SMALL = (FIGURE, "results/scenes/one.html", "results/measurements/mine.csv")


@pytest.fixture(scope="session")
def linked(project, tmp_path_factory) -> Path:
    """A copy of the sources with an overlay, in a path with a space and an umlaut."""
    folder = copy_project(project, tmp_path_factory.mktemp("a copy für tests"), link=True)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    return folder


@pytest.fixture(scope="session")
def imitated(project, tmp_path_factory) -> Path:
    """A copy with results in which every job only wrote its step, settings and inputs."""
    folder = copy_project(project, tmp_path_factory.mktemp("imitated") / "copy")
    imitate_steps(folder)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    made(folder, "--quiet", "--", *TARGETS, overlay="overlay.yaml", cores=2)
    return folder


@pytest.fixture
def small(imitated, tmp_path) -> Path:
    """A copy of the project with imitated results, which a test may change."""
    return Path(shutil.copytree(imitated, tmp_path / "copy", symlinks=True))
