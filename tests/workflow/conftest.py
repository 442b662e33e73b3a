"""Folders with results of imitated jobs, for tests of which results are made again."""

import shutil
from pathlib import Path

import pytest
import yaml
from pipeline_copy import OVERLAY, copy_project, imitate_steps, made

# Targets that together make all files; scenes have some that are only made by name.
TARGETS = ("everything", "scenes")
# Rules that only name targets.
NAMES = {"all", *TARGETS}
FIGURE = "results/figures/fig07_damage_zone.png"
# Targets that most of the rules take part in.
SMALL = (FIGURE, "results/scenes/one.html", "results/measurements/mine.csv")


@pytest.fixture(scope="session")
def linked(project, tmp_path_factory) -> Path:
    """A copy of the project's sources, with a space and an umlaut in its path, and an overlay."""
    folder = copy_project(project, tmp_path_factory.mktemp("a copy für tests"), link=True)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    return folder


@pytest.fixture(scope="session")
def imitated(project, tmp_path_factory) -> Path:
    """A copy in which every job was imitated by one that writes what it is made by and from."""
    folder = copy_project(project, tmp_path_factory.mktemp("imitated") / "copy")
    imitate_steps(folder)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    made(folder, "--quiet", "--", *TARGETS, overlay="overlay.yaml", cores=2)
    return folder


@pytest.fixture
def small(imitated, tmp_path) -> Path:
    """A copy of the project with imitated results, to be changed; tests ask for a few of them."""
    return Path(shutil.copytree(imitated, tmp_path / "copy", symlinks=True))
