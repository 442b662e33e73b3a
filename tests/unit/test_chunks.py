"""Chunks of a sweep: each has some of the runs at about equal cost; joined they are the sweep."""

from itertools import chain

import numpy as np
import pytest

from slippulse.data.files import CONFIGURATION_VARIABLE, UnreadableFile
from slippulse_paper.configuration.chunks import runs_of
from slippulse_paper.configuration.resolve import resolve
from slippulse_paper.steps import join, measure, simulate, study_grid

# The digest of a configuration, which each file notes.
DIGEST = "0123456789abcdef"
COARSE = {"dx": 0.2, "max_step": 0.5, "order": 4}
# Levels of both signs, so that some runs have a transition and others none, in chunks of either
# kind alone too. A level of 0, so that integers in one chunk are fractions in the next.
PLANE = {"boundary": "displacement", "left": [-0.2, 0.0, 0.5], "right": [0.0, 0.5]}
PLANE |= {"gamma": [0.65, 1.0], "duration": {"time": 5.0}, "resolved_blocks": 1}
PLANE |= {"record": ["fronts", "fields", "samples"]}
PLANE |= {"samples": {"times": 3, "positions": 11, "extent": 5.0}}
LOADED = {"boundary": "stress", "left": [-0.5, 0.0, 0.3], "right": [0.0, -0.4]}
LOADED |= {"width": [0.5, 1.0], "duration": {"time": 5.0}, "release": ["total", "elastic"]}
# A symmetric profile and an oblique one.
PROFILES = [{"left": 0.3, "right": 0.3}, {"left": 0.5, "right": 0.3, "steps": [[2.0, 0.1]]}]
LISTED = {"boundary": "displacement", "gamma": [0.65], "profiles": PROFILES, "resolved_blocks": 1}
LISTED |= {"duration": {"time": 4.0}, "record": ["fronts", "samples"]}
LISTED |= {"samples": {"times": 4, "positions": 1, "extent": 0.0}}
SWEEPS = {"displacement": PLANE, "stress": LOADED | {"record": ["fronts"]}, "profiles": LISTED}


@pytest.mark.parametrize(("chunks", "runs"), [(1, 5), (2, 2), (2, 7), (7, 7), (8, 81), (100, 1234)])
def test_each_run_is_in_one_chunk(chunks, runs):
    members = [list(runs_of(number, chunks, runs)) for number in range(1, chunks + 1)]
    assert sorted(chain.from_iterable(members)) == list(range(runs))
    assert all(chunk == sorted(chunk) for chunk in members)
    assert {len(chunk) for chunk in members} <= {runs // chunks, -(-runs // chunks)}


@pytest.mark.parametrize("inner", [8, 10, 20, 99, 100, 101])
def test_periodic_costs_are_spread_evenly_over_chunks(inner):
    cost = np.tile(np.r_[np.ones(inner - 1), inner], 40_000 // inner)
    sums = np.array([cost[list(runs_of(number, 10, cost.size))].sum() for number in range(1, 11)])
    # With a fixed first chunk one of ten would have half of all costs at 10, 20 and 100.
    assert sums.max() < 1.2 * sums.mean()


@pytest.fixture(scope="module")
def made(shipped, tmp_path_factory):
    folder = tmp_path_factory.mktemp("chunks")

    def make(name: str, chunk: list[int] | None = None) -> list:
        block = resolve(SWEEPS[name], shipped["model"], COARSE)
        block |= {"chunk": chunk} if chunk else {}
        blocks = {factor: block | {"coarser": factor} for factor in (1.0, 1.5, 2.0)}
        endings = (".nc", ".csv", "_study.csv", "_coarser.csv")
        files = [folder / f"{name}{chunk or ''}{ending}" for ending in endings]
        if not files[0].exists():
            kinds = ("data", "measured", "uncertainties", "coarser")
            outputs = dict(zip(kinds, files, strict=True))
            settings = {"simulation": name, "measure": shipped["measure"], "threads": 1}
            settings["solver"] = simulate.SOLVERS[blocks[1.0]["scheme"]]
            with pytest.MonkeyPatch.context() as patch:
                patch.setenv(CONFIGURATION_VARIABLE, DIGEST)
                simulate.run({}, outputs, settings | {"sweep": blocks.pop(1.0)})
            measure.run(outputs, outputs, settings)
            study_grid.run({"finest": files[1]}, outputs, settings | {"sweeps": blocks})
        return files

    return make


KINDS = ("data", "measurements", "uncertainties", "uncertainties/coarser")
JOINED = [("displacement", 2), ("stress", 5), ("displacement", 5), ("profiles", 2)]
JOINED[1:] = [pytest.param(*case, marks=pytest.mark.slow) for case in JOINED[1:]]


@pytest.mark.parametrize(("name", "chunks"), JOINED)
def test_joined_chunks_have_the_bytes_of_the_complete_sweep(
    made, tmp_path, name, chunks, monkeypatch
):
    sweep = made(name)
    files_of_chunks = [made(name, [number, chunks]) for number in range(1, chunks + 1)]
    joined = [tmp_path / file.name for file in sweep]
    monkeypatch.setenv(CONFIGURATION_VARIABLE, DIGEST)
    for kind, *files, path in zip(KINDS, *files_of_chunks, joined, strict=True):
        settings = {"kind": kind, "record": SWEEPS[name]["record"]}
        join.run({"chunks": files, "finest": [joined[1]]}, {"joined": path}, settings)
    for one, other in zip(sweep, joined, strict=True):
        assert one.read_bytes() == other.read_bytes(), one.name


def test_chunks_of_different_sweeps_are_not_joined(made, tmp_path):
    sweep = made("displacement")
    short, long = made("displacement", [1, 5]), made("displacement", [2, 2])
    outputs = {"joined": tmp_path / "joined"}
    for index, kind in enumerate(KINDS):
        files = {"chunks": [short[index], long[index]], "finest": [sweep[1]]}
        with pytest.raises(UnreadableFile, match="do not contain the runs of one sweep"):
            join.run(files, outputs, {"kind": kind, "record": ["fronts", "fields"]})
    assert not any(tmp_path.iterdir())


def test_a_table_with_a_row_too_many_is_named(made, tmp_path):
    first, second = made("displacement", [1, 2]), made("displacement", [2, 2])
    index = -1
    lines = second[index].read_text(encoding="utf-8").splitlines(keepends=True)
    longer = tmp_path / "longer.csv"
    longer.write_text("".join([*lines, lines[-1]]), encoding="utf-8")
    files = {"chunks": [first[index], longer], "finest": [first[1]]}
    with pytest.raises(UnreadableFile, match=r"longer\.csv"):
        join.run(files, {"joined": tmp_path / "joined"}, {"kind": KINDS[index], "record": []})
