"""A folder with every result, for tests of which results are made anew."""

from pathlib import Path

import pytest
import yaml
from pipeline_copy import OVERLAY, copy_project, imitate_steps, made, planned, snakemake

# Targets that together make all files; scenes have some that are only made by name.
TARGETS = ("everything", "scenes")
# Rules that only name targets.
NAMES = {"all", *TARGETS}


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
    assert planned(snakemake(folder, "--dry-run", "--", *TARGETS, overlay="overlay.yaml")) == {}
    return folder
