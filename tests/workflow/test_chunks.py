"""Sweeps in chunks: only lost files are made again, and they have the same bytes."""

import json
from pathlib import Path

import pytest
from pipeline_copy import SWEEP, copy_project, made, planned, refused, snakemake

pytestmark = pytest.mark.slow

LEVELS = [0.3, -0.2, 0.5, 0.4, 0.0, 0.6, 0.7]
FILES = ("data/{}.nc", "measurements/{}.csv", "uncertainties/{}.csv")
FILES += ("uncertainties/coarser/{}.csv",)
targets = lambda sweep, files=FILES: [f"results/{file}".format(sweep) for file in files]


def write_overlay(folder: Path, name: str, **changes) -> str:
    """Write an overlay with a sweep of some levels, in two chunks."""
    sweep = SWEEP | {"left": LEVELS, "resolved_blocks": 4} | changes
    overlay = {"preset": "draft", "simulations": {"mine": sweep}}
    (folder / name).write_text(json.dumps(overlay), encoding="utf-8")
    return name


@pytest.fixture(scope="module")
def folder(project, tmp_path_factory) -> Path:
    """A copy with the results of the sweep, of whose chunks one has one run more than the other."""
    folder = copy_project(project, tmp_path_factory.mktemp("chunks"), link=True)
    overlay = write_overlay(folder, "overlay.yaml")
    made(folder, "--quiet", "--", *targets("mine"), overlay=overlay, cores=2)
    return folder


@pytest.mark.parametrize(
    ("changes", "files", "jobs"),
    [
        ({"chunks": 3}, FILES, {"simulate": 3, "measure": 3, "study_grid": 3, "join": 4}),
        # The joined data are not needed.
        ({"left": [*LEVELS[:-1], 0.8]}, FILES[1:2], {"simulate": 2, "measure": 2, "join": 1}),
    ],
    ids=["more chunks", "another level"],
)
def test_nothing_is_taken_from_other_chunks(folder, changes, files, jobs):
    overlay = write_overlay(folder, "other.yaml", **changes)
    result = snakemake(folder, "--dry-run", "--", *targets("mine", files), overlay=overlay)
    assert planned(result) == jobs


def test_a_chunk_asked_for_by_name_is_made_again_to_the_same_bytes(folder):
    joined = [folder / target for target in targets("mine")]
    before = [path.read_bytes() for path in joined]
    lost = targets("mine/1-of-2")
    for target in lost:
        (folder / target).unlink()
    # The joined files do not need the chunks any more.
    asked = targets("mine")
    assert planned(snakemake(folder, "--dry-run", "--", *asked, overlay="overlay.yaml")) == {}
    output = made(folder, "--", *(lost + asked), overlay="overlay.yaml", cores=2).stderr
    assert "Simulating mine/1-of-2" in output and "2-of-2\n" not in output
    assert [path.read_bytes() for path in joined] == before


def test_a_job_elsewhere_does_not_check_every_run_again(folder):
    wrong = "simulations: {space_time_stress: {left: [1.0]}}"
    (folder / "wrong.yaml").write_text(wrong, encoding="utf-8")
    arguments = ("--dry-run", "--", "results/figures/fig07_damage_zone.png")
    here = refused(folder, *arguments, overlay="wrong.yaml")
    assert "space_time_stress.prestress.left: 1.0" in here
    made(folder, "--mode", "remote", *arguments, overlay="wrong.yaml")
