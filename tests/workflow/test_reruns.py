"""An alteration runs again exactly what depends on it: dry runs in a copy in which everything is finished."""

import os
from collections.abc import Iterable
from pathlib import Path

import pytest
import yaml
from dependencies import DRAWN, FILES, OVERLAY, RULES, STUDIED, rules_of
from pipeline_copy import copy_project, edges, imitate_steps, merged, planned, snakemake

from slippulse.steps.predict import TOPICS
from slippulse.steps.reach import declared

pytestmark = pytest.mark.workflow

TARGETS = ("everything", "scenes")
# Rules that only name targets.
NAMES = {"all", *TARGETS}


@pytest.fixture(scope="module")
def finished(project, tmp_path_factory) -> Path:
    """A copy in which every job was imitated."""
    folder = copy_project(project, tmp_path_factory.mktemp("reruns"))
    imitate_steps(folder)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    made = snakemake(folder, "--quiet", "--", *TARGETS, overlay="overlay.yaml", cores=2, timeout=1200)
    assert made.returncode == 0, made.stderr
    assert planned(snakemake(folder, "--dry-run", "--", *TARGETS, overlay="overlay.yaml")) == {}
    return folder


@pytest.fixture(scope="module")
def fed_by(finished) -> dict[str, set[str]]:
    """Rules that take what a rule makes."""
    graph = snakemake(finished, "--rulegraph", "mermaid-js", "--", *TARGETS, overlay="overlay.yaml").stdout
    found: dict[str, set[str]] = {}
    for feeding, fed in edges(graph):
        found.setdefault(feeding, set()).add(fed)
    return found


def downstream(rules: Iterable[str], fed_by: dict[str, set[str]]) -> set[str]:
    """Some rules and all that takes what they make, directly or not."""
    found, pending = set(), [*rules]
    while pending:
        rule = pending.pop()
        if rule not in found:
            found.add(rule)
            pending += fed_by.get(rule, ())
    return found - NAMES


def jobs_after(folder: Path, overlay: str = "overlay.yaml") -> dict[str, int]:
    """Jobs of a dry run, without those that only name targets."""
    jobs = planned(snakemake(folder, "--dry-run", "--", *TARGETS, overlay=overlay))
    return {rule: count for rule, count in jobs.items() if rule not in NAMES}


LOCK = "requirements.lock"
# One of each folder: that every file is a source of the rules that reach it is seen in `test_dependencies`.
EDITED = {Path(file).parent: file for file in FILES if Path(file).stem not in TOPICS}.values()


@pytest.mark.slow
@pytest.mark.parametrize("file", (*EDITED, LOCK))
def test_an_edit_runs_what_depends_on_the_file(finished, fed_by, file):
    assert set(jobs_after_edit(finished, file)) == downstream(
        RULES if file == LOCK else rules_of(file), fed_by
    )


@pytest.mark.slow
def test_an_edited_topic_of_theory_runs_what_reads_it(finished):
    jobs = set(jobs_after_edit(finished, "src/slippulse/predict/pulse.py"))
    assert {"predict", "sweep_own", "draw_scene", "fig08_steady_state_displacement"} <= jobs
    assert not jobs & {"fig02_phase_diagram", "fig05_scaling", "study_front_speed", "study_arrest"}


def jobs_after_edit(finished, file: str) -> dict[str, int]:
    """What runs when a file has one line more."""
    path = finished / file
    before, stat = path.read_bytes(), path.stat()
    try:
        path.write_bytes(before + b"\n# edited\n")
        return jobs_after(finished)
    finally:
        path.write_bytes(before)
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))


# What is removed, and the jobs that make it again: no others, since what they make is the same as before.
REMOVED = {
    "results/data/steady_stress.nc": "simulate",
    "results/measurements/scaling_stress.csv": "measure",
    "results/uncertainties/mine.csv": "study_grid",
    "results/data/own.nc": "join",
    "results/scenes/mine.pdf": "draw_scene",
    "results/figures/fig07_damage_zone.csv": "fig07_damage_zone",
    "results/studies/extremes.csv": "study_of_extremes",
}


@pytest.mark.slow
def test_what_is_removed_is_made_by_the_default_target(finished):
    kept = {name: (finished / name).read_bytes() for name in REMOVED}
    try:
        for name in REMOVED:
            (finished / name).unlink()
        jobs = planned(snakemake(finished, "--dry-run", overlay="overlay.yaml"))
    finally:
        for name, content in kept.items():
            (finished / name).write_bytes(content)
    assert set(REMOVED.values()) | {"write_provenance", "write_index"} <= set(jobs)
    # A chunk of another sweep is not simulated again.
    assert jobs["simulate"] == jobs["join"] == jobs["fig07_damage_zone"] == 1


def test_an_edited_figure_redraws_that_figure_alone():
    """Predictions that two figures share do not stand in the module of one of them."""
    for name in DRAWN:
        assert rules_of(f"src/slippulse/figures/{name}.py") - {"write_provenance"} == {name}


# The whole configuration stands in the report and in the provenance, what differs from the shipped one on the pages.
# And a study draws the claims.
ALWAYS = dict.fromkeys(
    ("write_claims", "study_open_choices", "write_report", "write_provenance", "write_index"), 1
)
CHAIN = {"simulate": 1, "measure": 1, "predict": 1, "study_grid": 1}
JOINED = {"join": 4}
CONFIGURATIONS = {
    "another level": (
        {"simulations": {"space_time_displacement": {"left": [0.3]}}},
        CHAIN | {"fig04_space_time": 1, "study_published_figure": 1} | dict.fromkeys(
            ("study_of_exact_space_time", "study_of_derivations"), 1
        ),
    ),
    "swapped values": (
        {"simulations": {"own": {"left": [0.5, 0.3]}}}, dict.fromkeys(CHAIN, 2) | JOINED | {"sweep_own": 1},
    ),
    "without chunks": ({"simulations": {"own": {"chunks": 1}}}, CHAIN | {"sweep_own": 1}),
    "another sketch": (
        {"figures": {"fig07_damage_zone": {"thickness_ratios": [0.3, 1.0]}}},
        {"study_of_damage_zone": 1, "fig07_damage_zone": 1},
    ),
    "another title": (
        {"scenes": {"barrier": {"title": "Uno"}}}, {"draw_scene": 1, "animate_scene": 1, "write_scenes_page": 1},
    ),
    "another tolerance": ({"claims": {"front_speed": {"tolerance": 0.5}}}, {}),
    "permission for large sweeps": ({"allow_large": True}, {}),
}  # fmt: skip


@pytest.fixture
def jobs_with(finished):
    """A function that gives the jobs of a dry run with some values altered."""

    def jobs(change: dict) -> dict[str, int]:
        (finished / "changed.yaml").write_text(yaml.safe_dump(merged(OVERLAY, change)), encoding="utf-8")
        return jobs_after(finished, "changed.yaml")

    return jobs


@pytest.mark.slow
@pytest.mark.parametrize("case", CONFIGURATIONS)
def test_another_configuration_runs_only_its_chain(jobs_with, case):
    change, expected = CONFIGURATIONS[case]
    assert jobs_with(change) == expected | ALWAYS


def studies_without(*read: str) -> set[str]:
    """Studies that read none of some kinds of files and parts of the configuration."""
    needs = {rule: declared(f"studies.{study}", "NEEDS") for rule, study in STUDIED.items()}
    return {
        rule
        for rule, found in needs.items()
        if not any(key.startswith(read) for key in (*found, *found.get("settings", ())) if key != "settings")
    }


TABLES = ("data", "measured", "predicted", "uncertainties", "coarser", "studies")
# Shared values, with rules that read them and rules that must not run for them.
SKETCHES = {"fig01_system_sketch", "fig07_damage_zone", "study_barriers", "compile_kernels"}
DATA = {"simulate", "animate_scene", "fig06_burridge_knopoff"}
UNMODELLED = studies_without(*TABLES, "sweeps", "model")
HELD = {"fig08_steady_state_displacement", "fig10_damping_displacement"}
SHARED = {
    "share": (
        {"measure": {"share": 0.9}},
        {"measure", "study_grid", "draw_scene", "write_claims", "fig05_scaling"},
        SKETCHES | DATA | HELD | studies_without(*TABLES, "measure.share"),
    ),
    "damping": (
        {"model": {"damping_ratio": 0.2}},
        {"simulate", "measure", "study_grid", "animate_scene", "fig04_space_time"},
        # Its simulations have damping ratios of their own; figure 8 draws a study that reads those of figure 9 too.
        SKETCHES | UNMODELLED | {"fig10_damping_displacement"},
    ),
    "front window": (
        {"measure": {"front_window": 0.4}},
        {"measure", "study_of_extremes", "fig03_steady_state"},
        SKETCHES | DATA | studies_without(*TABLES, "measure.front_window"),
    ),
    "release": ({"model": {"release": "elastic"}}, {"simulate", "draw_scene"}, SKETCHES | UNMODELLED),
    "coarser": ({"presets": {"paper": {"coarser": [2.0, 3.0]}}}, {"study_grid", "draw_scene"}, {"simulate", "measure"}),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("case", SHARED)
def test_a_shared_value_runs_what_reads_it_and_no_more(jobs_with, case):
    change, read_by, untouched = SHARED[case]
    jobs = jobs_with(change)
    assert read_by | set(ALWAYS) <= set(jobs)
    assert not untouched & set(jobs), untouched & set(jobs)
    assert untouched <= RULES
