"""A sweep in chunks through Snakemake: the bytes of the sweep in one job, and only what is lost is made again."""

import shutil
from pathlib import Path

import pytest
from pipeline_copy import copy_project, planned, snakemake

from slippulse.data.store import load_dataset

pytestmark = [pytest.mark.workflow, pytest.mark.slow]

SWEEP = {
    "boundary": "displacement", "left": [0.3, -0.2, 0.5, 0.4, 0.0, 0.6, 0.7], "right": "same", "gamma": [0.65],
    "duration": {"time": 6.0}, "spacing": {"scale": 4.0}, "record": ["fronts", "fields"], "resolved_blocks": 4,
}  # fmt: skip
CHUNKS = {"in_none": None, "in_one": 1, "in_two": 2, "in_three": 3}
FILES = ("data/{}.nc", "measurements/{}.csv", "uncertainties/{}.csv", "uncertainties/coarser/{}.csv")


def write_overlay(folder: Path, name: str, chunks: dict, **changes) -> str:
    sweeps = {
        sweep: SWEEP | changes | ({"chunks": count} if count else {}) for sweep, count in chunks.items()
    }
    text = "preset: draft\n" + "".join(f"  {key}: {sweep}\n" for key, sweep in sweeps.items())
    (folder / name).write_text(text.replace("draft\n", "draft\nsimulations:\n"), encoding="utf-8")
    return name


def targets(*sweeps: str, files=FILES) -> list[str]:
    return [f"results/{file}".format(sweep) for sweep in sweeps for file in files]


@pytest.fixture(scope="module")
def folder(project, tmp_path_factory) -> Path:
    """A copy in which a sweep has been made whole, kept apart, and then in two chunks, one a run longer."""
    folder = copy_project(project, tmp_path_factory.mktemp("chunks"), link=True)
    overlay = write_overlay(folder, "whole.yaml", {"in_two": None})
    for made in (overlay, write_overlay(folder, "overlay.yaml", CHUNKS)):
        result = snakemake(folder, "--quiet", "--", *targets("in_two"), overlay=made, cores=2)
        assert result.returncode == 0, result.stderr
        if made == overlay:
            shutil.copytree(folder / "results", folder / "whole")
    return folder


def test_the_bytes_are_those_of_the_sweep_in_one_job(folder):
    data = FILES[0].format("in_two")
    digests = [
        load_dataset(folder / tree / data).attrs["configuration"].encode() for tree in ("whole", "results")
    ]
    for file in FILES:
        whole, joined = (
            (folder / tree / file.format("in_two")).read_bytes() for tree in ("whole", "results")
        )
        # The configuration says how many chunks there are.
        assert whole.replace(*digests) == joined, file
    chunks = sorted(path.name for path in (folder / "results/data/in_two").glob("*.nc"))
    assert chunks == ["1-of-2.nc", "2-of-2.nc"]


def test_a_sweep_without_chunks_has_no_other_jobs(folder):
    for name in ("in_none", "in_one"):
        result = snakemake(folder, "--dry-run", "--forceall", "--", *targets(name), overlay="overlay.yaml")
        assert planned(result) == {"compile_kernels": 1, "simulate": 1, "measure": 1, "study_grid": 1}


def test_numbers_do_not_need_the_joined_data(folder):
    result = snakemake(
        folder, "--dry-run", "--forceall", "--", *targets("in_three", files=FILES[1:]), overlay="overlay.yaml"
    )
    assert planned(result) == {"compile_kernels": 1, "simulate": 3, "measure": 3, "study_grid": 3, "join": 3}


@pytest.mark.parametrize(
    ("lost", "jobs"),
    [
        (FILES, {"simulate": 1, "measure": 1, "study_grid": 1, "join": 4}),
        (FILES[1:], {"measure": 1, "study_grid": 1, "join": 3}),
        (FILES[2:], {"study_grid": 1, "join": 2}),
    ],
    ids=["all files", "all but its data", "its grid study"],
)
def test_a_killed_chunk_is_made_again_alone(folder, lost, jobs):
    paths = [folder / target for target in targets("in_two/2-of-2", "in_two", files=lost)]
    kept = [path.rename(path.with_suffix(".kept")) for path in paths]
    try:
        result = snakemake(folder, "--dry-run", "--", *targets("in_two", files=lost), overlay="overlay.yaml")
        assert planned(result) == jobs
    finally:
        for path, away in zip(paths, kept, strict=True):
            away.rename(path)


def test_a_chunk_asked_for_by_name_is_made_again_to_the_same_bytes(folder):
    joined = [folder / target for target in targets("in_two")]
    before = [path.read_bytes() for path in joined]
    lost = targets("in_two/1-of-2")
    for target in lost:
        (folder / target).unlink()
    # What the joined files were made from is not missed.
    assert planned(snakemake(folder, "--dry-run", "--", *targets("in_two"), overlay="overlay.yaml")) == {}
    result = snakemake(folder, "--", *lost, *targets("in_two"), overlay="overlay.yaml", cores=2)
    assert result.returncode == 0, result.stderr
    assert "Simulating in_two/1-of-2" in result.stderr and "2-of-2\n" not in result.stderr
    assert [path.read_bytes() for path in joined] == before


def test_another_number_of_chunks_takes_nothing_from_the_old_ones(folder):
    overlay = write_overlay(folder, "other.yaml", {"in_two": 3})
    result = snakemake(folder, "--dry-run", "--", *targets("in_two"), overlay=overlay)
    assert planned(result) == {"simulate": 3, "measure": 3, "study_grid": 3, "join": 4}
    overlay = write_overlay(folder, "none.yaml", {"in_two": None})
    result = snakemake(folder, "--dry-run", "--", *targets("in_two"), overlay=overlay)
    assert planned(result) == {"simulate": 1, "measure": 1, "study_grid": 1}


def test_another_level_runs_all_chunks_again(folder):
    overlay = write_overlay(folder, "level.yaml", {"in_two": 2}, left=[0.3, -0.2, 0.5, 0.4, 0.1, 0.6, 0.7])
    result = snakemake(folder, "--dry-run", "--", *targets("in_two", files=FILES[1:2]), overlay=overlay)
    assert planned(result) == {"simulate": 2, "measure": 2, "join": 1}


@pytest.mark.parametrize(
    "chunk", ["in_two/1-of-3", "in_two/3-of-2", "in_two/0-of-2", "in_none/1-of-1", "in_one/1-of-1"]
)
def test_a_chunk_that_there_is_not_is_refused(folder, chunk):
    result = snakemake(folder, "--", f"results/data/{chunk}.nc", overlay="overlay.yaml")
    said = result.stdout + result.stderr
    assert result.returncode != 0 and "Traceback" not in said
    assert f"target: 'results/data/{chunk}.nc'" in said and "allowed: a rule of a single job" in said


def test_a_job_elsewhere_does_not_check_every_run_again(folder):
    (folder / "wrong.yaml").write_text("simulations: {space_time_stress: {left: [1.0]}}", encoding="utf-8")
    arguments = ("--dry-run", "--", "results/figures/fig07_damage_zone.png")
    here = snakemake(folder, *arguments, overlay="wrong.yaml")
    assert here.returncode != 0 and "space_time_stress.prestress.left: 1.0" in here.stdout + here.stderr
    elsewhere = snakemake(folder, "--mode", "remote", *arguments, overlay="wrong.yaml")
    assert elsewhere.returncode == 0, elsewhere.stderr
