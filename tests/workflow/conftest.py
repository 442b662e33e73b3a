"""Folders with results of imitated jobs, for tests of which results are made again."""

import shutil
from pathlib import Path

import pytest
import yaml
from pipeline_copy import OVERLAY, copy_project, imitate_steps, made, planned, snakemake

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


def imitate(project: Path, folder: Path, *targets: str) -> Path:
    """Copy the project, and make some targets by jobs that write by what and from what."""
    folder = copy_project(project, folder)
    imitate_steps(folder)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    made(folder, "--quiet", "--", *targets, overlay="overlay.yaml", cores=2)
    return folder


@pytest.fixture(scope="session")
def imitated(project, tmp_path_factory) -> Path:
    """A copy in which every job was imitated by one that writes what it is made by and from."""
    folder = imitate(project, tmp_path_factory.mktemp("imitated") / "copy", *TARGETS)
    assert planned(snakemake(folder, "--dry-run", "--", *TARGETS, overlay="overlay.yaml")) == {}
    return folder


@pytest.fixture(scope="session")
def small_results(project, tmp_path_factory) -> Path:
    """A copy with the imitated results of a few targets; tests take copies of it."""
    return imitate(project, tmp_path_factory.mktemp("small") / "copy", *SMALL)


@pytest.fixture
def small(small_results, tmp_path) -> Path:
    """A copy of the project with the imitated results of a few targets, to be changed."""
    return Path(shutil.copytree(small_results, tmp_path / "copy", symlinks=True))
