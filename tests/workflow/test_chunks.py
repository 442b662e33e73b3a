"""A sweep in chunks through Snakemake: only what is lost is made again, to the same bytes."""

import json
from pathlib import Path

import pytest
from pipeline_copy import SWEEP, copy_project, made, planned, refused, snakemake

pytestmark = pytest.mark.slow

LEVELS = [0.3, -0.2, 0.5, 0.4, 0.0, 0.6, 0.7]
OTHER_LEVEL = {"left": [*LEVELS[:-1], 0.8]}
JOBS_OF_A_TABLE = {"simulate": 2, "measure": 2, "join": 1}
TABLES_ANEW = {"measure": 1, "study_grid": 1, "join": 3}
CHUNKS = {"in_none": None, "in_one": 1, "in_two": 2, "in_three": 3}
FILES = ("data/{}.nc", "measurements/{}.csv", "uncertainties/{}.csv")
FILES += ("uncertainties/coarser/{}.csv",)
targets = lambda sweep, files=FILES: [f"results/{file}".format(sweep) for file in files]


def write_overlay(folder: Path, name: str, sweeps: dict[str, int | None], **changes) -> str:
    """Write an overlay with sweeps of some levels, by how many chunks each has, or None."""
    sweep = SWEEP | {"left": LEVELS, "resolved_blocks": 4} | changes
    del sweep["chunks"]
    chunked = {name: {"chunks": count} if count else {} for name, count in sweeps.items()}
    simulations = {name: sweep | chunks for name, chunks in chunked.items()}
    overlay = {"preset": "draft", "simulations": simulations}
    (folder / name).write_text(json.dumps(overlay), encoding="utf-8")
    return name


@pytest.fixture(scope="module")
def folder(project, tmp_path_factory) -> Path:
    """A copy in which a sweep was made in two chunks, one a run longer."""
    folder = copy_project(project, tmp_path_factory.mktemp("chunks"), link=True)
    overlay = write_overlay(folder, "overlay.yaml", CHUNKS)
    made(folder, "--quiet", "--", *targets("in_two"), overlay=overlay, cores=2)
    return folder


def jobs(count: int, **others: int) -> dict[str, int]:
    """Jobs by rule, with as many simulations, measurements and grid studies as there are chunks."""
    return dict.fromkeys(("simulate", "measure", "study_grid"), count) | others


def case(identity: str, name: str, files=FILES, sweeps=CHUNKS, **parts):
    """A sweep and its files that are asked for, and which jobs then run."""
    return pytest.param(sweeps, name, files, parts, id=identity)


@pytest.mark.parametrize(
    ("sweeps", "name", "files", "parts"),
    [
        case("no chunks", "in_none", forced=True, jobs=jobs(1, compile_kernels=1)),
        case("one chunk", "in_one", forced=True, jobs=jobs(1, compile_kernels=1)),
        # The joined data are not needed.
        case("tables", "in_three", FILES[1:], forced=True, jobs=jobs(3, compile_kernels=1, join=3)),
        case("more chunks", "in_two", sweeps={"in_two": 3}, jobs=jobs(3, join=4)),
        case("chunks no more", "in_two", sweeps={"in_two": None}, jobs=jobs(1)),
        case("another level", "in_two", FILES[1:2], changes=OTHER_LEVEL, jobs=JOBS_OF_A_TABLE),
        case("lost chunk", "in_two", lost=True, jobs=jobs(1, join=4)),
        case("lost tables", "in_two", FILES[1:], lost=True, jobs=TABLES_ANEW),
        case("lost study", "in_two", FILES[2:], lost=True, jobs={"study_grid": 1, "join": 2}),
    ],
)
def test_what_runs(folder, sweeps, name, files, parts):
    """Nothing is taken from another number of chunks, and a lost chunk is made again alone."""
    lost = targets("in_two/2-of-2", files) + targets(name, files) if "lost" in parts else []
    kept = [(folder / path).rename(folder / f"{path}.kept") for path in lost]
    arguments = ["--dry-run", "--", *targets(name, files)]
    if "forced" in parts:
        arguments.insert(0, "--forceall")
    try:
        overlay = write_overlay(folder, "other.yaml", sweeps, **parts.get("changes", {}))
        result = snakemake(folder, *arguments, overlay=overlay)
    finally:
        for path in kept:
            path.rename(path.with_suffix(""))
    assert planned(result) == parts["jobs"]


def test_a_chunk_asked_for_by_name_is_made_again_to_the_same_bytes(folder):
    joined = [folder / target for target in targets("in_two")]
    before = [path.read_bytes() for path in joined]
    lost = targets("in_two/1-of-2")
    for target in lost:
        (folder / target).unlink()
    # A file that the joined files were made from is not missed.
    asked = targets("in_two")
    assert planned(snakemake(folder, "--dry-run", "--", *asked, overlay="overlay.yaml")) == {}
    said = made(folder, "--", *(lost + asked), overlay="overlay.yaml", cores=2).stderr
    assert "Simulating in_two/1-of-2" in said and "2-of-2\n" not in said
    assert [path.read_bytes() for path in joined] == before


def test_a_job_elsewhere_does_not_check_every_run_again(folder):
    wrong = "simulations: {space_time_stress: {left: [1.0]}}"
    (folder / "wrong.yaml").write_text(wrong, encoding="utf-8")
    arguments = ("--dry-run", "--", "results/figures/fig07_damage_zone.png")
    here = refused(folder, *arguments, overlay="wrong.yaml")
    assert "space_time_stress.prestress.left: 1.0" in here
    made(folder, "--mode", "remote", *arguments, overlay="wrong.yaml")
