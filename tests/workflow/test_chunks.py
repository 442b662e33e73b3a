"""A sweep in chunks through Snakemake: the bytes of the sweep in one job, and only what is lost is made again."""

import json
import shutil
from pathlib import Path

import pytest
from pipeline_copy import SWEEP, copy_project, planned, snakemake

from slippulse.data.store import load_dataset

pytestmark = pytest.mark.slow

LEVELS = [0.3, -0.2, 0.5, 0.4, 0.0, 0.6, 0.7]
CHUNKS = {"in_none": None, "in_one": 1, "in_two": 2, "in_three": 3}
FILES = (
    "data/{}.nc",
    "measurements/{}.csv",
    "uncertainties/{}.csv",
    "uncertainties/coarser/{}.csv",
)


def write_overlay(folder: Path, name: str, sweeps: dict[str, int | None], **changes) -> str:
    """Sweeps of some levels in some numbers of chunks, or without."""
    sweep = {key: value for key, value in SWEEP.items() if key != "chunks"}
    sweep |= {"left": LEVELS, "resolved_blocks": 4} | changes
    found = {
        name: sweep | ({"chunks": chunks} if chunks else {}) for name, chunks in sweeps.items()
    }
    (folder / name).write_text(
        json.dumps({"preset": "draft", "simulations": found}), encoding="utf-8"
    )
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
    files, trees = [file.format("in_two") for file in FILES], [folder / "whole", folder / "results"]
    digests = [load_dataset(tree / files[0]).attrs["configuration"].encode() for tree in trees]
    for file in files:
        whole, joined = ((tree / file).read_bytes() for tree in trees)
        # The configuration says how many chunks there are.
        assert whole.replace(*digests) == joined, file
    chunks = sorted(path.name for path in (folder / "results/data/in_two").glob("*.nc"))
    assert chunks == ["1-of-2.nc", "2-of-2.nc"]


ONE_JOB, THREE = ({"simulate": count, "measure": count, "study_grid": count} for count in (1, 3))
FORCED, KERNELS, LEVEL = ["--forceall"], {"compile_kernels": 1}, {"left": [*LEVELS[:-1], 0.8]}
# Numbers of chunks, what else is altered, the sweep and its files that are asked for, options, and jobs.
PLANS = {
    "without chunks there are no other jobs": (CHUNKS, {}, "in_none", FILES, FORCED, ONE_JOB | KERNELS),
    "nor with one": (CHUNKS, {}, "in_one", FILES, FORCED, ONE_JOB | KERNELS),
    "joined data are not needed": (CHUNKS, {}, "in_three", FILES[1:], FORCED, THREE | KERNELS | {"join": 3}),
    "another number of chunks takes nothing": ({"in_two": 3}, {}, "in_two", FILES, [], THREE | {"join": 4}),
    "nor does none": ({"in_two": None}, {}, "in_two", FILES, [], ONE_JOB),
    "with another level all run again": (
        CHUNKS, LEVEL, "in_two", FILES[1:2], [], {"simulate": 2, "measure": 2, "join": 1}
    ),
    "a lost chunk is made again alone": (CHUNKS, {}, "in_two", FILES, ["lost"], ONE_JOB | {"join": 4}),
    "or the rest": (CHUNKS, {}, "in_two", FILES[1:], ["lost"], {"measure": 1, "study_grid": 1, "join": 3}),
    "and only its grid study": (CHUNKS, {}, "in_two", FILES[2:], ["lost"], {"study_grid": 1, "join": 2}),
}  # fmt: skip


@pytest.mark.parametrize("case", PLANS)
def test_what_runs(folder, case):
    sweeps, changes, name, files, options, jobs = PLANS[case]
    lost = targets("in_two/2-of-2", name, files=files) if options == ["lost"] else []
    kept = [(folder / path).rename(folder / f"{path}.kept") for path in lost]
    options = [] if lost else options
    try:
        overlay = write_overlay(folder, "other.yaml", sweeps, **changes)
        result = snakemake(
            folder, "--dry-run", *options, "--", *targets(name, files=files), overlay=overlay
        )
    finally:
        for path in kept:
            path.rename(path.with_suffix(""))
    assert planned(result) == jobs


def test_a_chunk_asked_for_by_name_is_made_again_to_the_same_bytes(folder):
    joined = [folder / target for target in targets("in_two")]
    before = [path.read_bytes() for path in joined]
    lost = targets("in_two/1-of-2")
    for target in lost:
        (folder / target).unlink()
    # What the joined files were made from is not missed.
    assert (
        planned(snakemake(folder, "--dry-run", "--", *targets("in_two"), overlay="overlay.yaml"))
        == {}
    )
    result = snakemake(folder, "--", *lost, *targets("in_two"), overlay="overlay.yaml", cores=2)
    assert result.returncode == 0, result.stderr
    assert "Simulating in_two/1-of-2" in result.stderr and "2-of-2\n" not in result.stderr
    assert [path.read_bytes() for path in joined] == before


@pytest.mark.parametrize(
    "chunk", ["two/1-of-3", "two/3-of-2", "two/0-of-2", "none/1-of-1", "one/1-of-1"]
)
def test_a_chunk_that_there_is_not_is_refused(folder, chunk):
    result = snakemake(folder, "--", f"results/data/in_{chunk}.nc", overlay="overlay.yaml")
    said = result.stdout + result.stderr
    assert result.returncode != 0 and "Traceback" not in said
    assert (
        f"target: 'results/data/in_{chunk}.nc'" in said
        and "allowed: a rule of a single job" in said
    )


def test_a_job_elsewhere_does_not_check_every_run_again(folder):
    (folder / "wrong.yaml").write_text(
        "simulations: {space_time_stress: {left: [1.0]}}", encoding="utf-8"
    )
    arguments = ("--dry-run", "--", "results/figures/fig07_damage_zone.png")
    here = snakemake(folder, *arguments, overlay="wrong.yaml")
    assert (
        here.returncode != 0
        and "space_time_stress.prestress.left: 1.0" in here.stdout + here.stderr
    )
    elsewhere = snakemake(folder, "--mode", "remote", *arguments, overlay="wrong.yaml")
    assert elsewhere.returncode == 0, elsewhere.stderr
