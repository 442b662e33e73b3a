"""Edits and altered values run the rules that depend on them, and no others."""

import html
import os
import re
from collections import Counter
from collections.abc import Iterable
from functools import cache
from pathlib import Path

import grimp
import pytest
from pipeline_copy import made, planned_by_name, snakemake
from rules_by_imports import (
    DRAWN,
    EVERY_SOURCE,
    FILES,
    PACKAGE,
    RULES,
    combinations,
    files_of,
    rules_of,
)
from workflow.conftest import TARGET_RULES, TARGETS

from slippulse_paper.records.job_records import Record, RecordedFiles, digest_of, file_digest
from slippulse_paper.records.provenance import source_files
from slippulse_paper.steps.predict import MODULES as TOPIC_MODULES

LOCK = "requirements.lock"
# One file of each folder is edited. The test of digests below covers all files.
EDITED = {
    Path(file).parent: file for file in FILES if Path(file).stem not in TOPIC_MODULES.values()
}.values()


@pytest.fixture(scope="module")
def inputs(linked) -> dict[str, set[str]]:
    """Return the input files of each rule, from Snakemake's graph of all files."""
    targets = (*TARGETS, "results/predictions/mine.csv")
    result = made(linked, "--forceall", "--filegraph", "--", *targets, overlay="overlay.yaml")
    files = {}
    entry = r'point-size="18">(\w+)</font>(.*?)(?=point-size="18"|\Z)'
    for name, text in re.findall(entry, result.stdout, re.S):
        taken = text.partition("&#8618; input")[2].partition("output &rarr;")[0]
        found = set(map(html.unescape, re.findall(r'"monospace">([^<]+)<', taken)))
        files[name] = files.get(name, set()) | found
    return files


def test_the_code_of_each_job_is_what_its_step_reaches_and_nothing_else(imitated):
    """Each record has the digest of the files that the step imports, directly or indirectly."""
    digest = cache(lambda path: file_digest(imitated / path))

    def codes(rule: str) -> set[str]:
        texts = {LOCK} | {"write_report": {"CITATION.cff", "config/config.yaml"}}.get(rule, set())
        if rule in EVERY_SOURCE:
            paths = map(Path, source_files(imitated))
            texts |= {path.relative_to(imitated).as_posix() for path in paths}
        choices = [files_of(rule, names) | texts for names in combinations(rule)]
        return {digest_of({path: digest(path) for path in files}) for files in choices}

    codes, seen = cache(codes), set()
    for path, record in RecordedFiles(imitated / "results").records.items():
        rule = name_of(path, record)
        assert record.code in codes(rule), path
        seen.add(rule)
    assert seen == RULES and len(FILES) > 150
    # No figure imports the module of another figure.
    for name in DRAWN:
        assert rules_of(f"src/slippulse_paper/figures/{name}.py") == {name} | EVERY_SOURCE


def test_a_module_is_taken_by_name_only_where_the_rule_names_it():
    """Only these modules import others by computed names, which the graph of imports misses."""
    computed = {
        path.relative_to(PACKAGE).with_suffix("").as_posix()
        for path in PACKAGE.rglob("*.py")
        if re.search(r"\b(import_module|__import__|resolve_name)\(", path.read_text("utf-8"))
    }
    named = ("draw_figure", "job", "predict", "run_study", "simulate", "study_grid")
    assert computed == {f"steps/{name}" for name in named}


def test_checksums_and_manifest_cover_all_results_and_what_an_overlay_adds(inputs):
    listed = {file for file in inputs["write_index"] if file.startswith("results/")}
    assert inputs["everything"] == listed | {"results/provenance.json", "results/index.html"}
    for name in ("mine", "one", "barrier"):
        files = (f"data/{name}.nc", f"measurements/{name}.csv", f"uncertainties/{name}.csv")
        assert {f"results/{file}" for file in files} <= listed
    assert {f"results/scenes/one.{ending}" for ending in ("html", "png", "pdf", "csv")} <= listed
    # Seconds are measured in each whole run.
    assert "results/seconds/accuracy_cost.csv" in inputs["everything"]
    # Data of a figure and measurements of a claim are listed, too.
    assert {"results/data/steady_stress.nc", "results/measurements/scaling_stress.csv"} <= listed


@pytest.fixture(scope="module")
def downstream(imitated):
    """Return a function that finds all jobs that depend on some jobs, from the records."""
    taken = grimp.ImportGraph()
    records = RecordedFiles(imitated / "results").records
    jobs = {path: name_of(path, record) for path, record in records.items()}
    makers = {
        os.path.normpath(path.parent.parent / output): jobs[path]
        for path, record in records.items()
        for output in record.outputs
    }
    for path, record in records.items():
        for name in record.inputs:
            source = os.path.normpath(path.parent.parent / name)
            if makers.get(source, jobs[path]) != jobs[path]:
                taken.add_import(importer=jobs[path], imported=makers[source])

    def find(names: Iterable[str]) -> set[str]:
        known = taken.modules.intersection(names)
        return {*names}.union(*map(taken.find_downstream_modules, known))

    return find


def name_of(path: Path, record: Record) -> str:
    """Return the name of the job of a record: its step, or the figure or study that it makes."""
    name = next(iter(record.outputs)).partition(".")[0]
    return {"run_study": f"study_of_{name}", "draw_figure": name}.get(record.step, record.step)


def jobs_after(folder: Path, change: str = "{}") -> dict[str, int]:
    """Return the jobs of a dry run after an edit of a file or of some values.

    Rules that only list targets are left out.
    """
    file, values = (change, "{}") if change in (*FILES, LOCK) else ("overlay.yaml", change)
    (folder / "values.yaml").write_text(values, encoding="utf-8")
    path = folder / file
    before, stat = path.read_bytes(), path.stat()
    try:
        path.write_bytes(before + b"\n# edited\n")
        overlays = ("overlay.yaml", "values.yaml")
        jobs = planned_by_name(snakemake(folder, "--dry-run", "--", *TARGETS, overlay=overlays))
    finally:
        path.write_bytes(before)
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    return {rule: count for rule, count in jobs.items() if rule not in TARGET_RULES}


@pytest.mark.slow
@pytest.mark.parametrize("file", (*EDITED, LOCK))
def test_an_edit_runs_what_depends_on_the_file(imitated, downstream, file):
    assert set(jobs_after(imitated, file)) == downstream(RULES if file == LOCK else rules_of(file))


# These jobs run after every change. The report and the provenance contain the whole configuration,
# the claims page shows what an overlay alters, and a study draws the claims.
ALWAYS = {"write_claims", "study_open_choices", "write_report", "write_index"}
CHAIN = ("simulate", "measure", "predict", "study_grid")
PUBLISHED = ("study_published_figure", "study_of_exact_space_time", "study_of_derivations")
PUBLISHED += ("fig04_space_time",)
SCENES = ("draw_scene", "animate_scene", "write_scenes_page")
FIGURE = "fig07_damage_zone"
# Changes of the configuration, and the jobs that then run in addition.
CONFIGURATIONS = {
    "simulations: {space_time_displacement: {left: [0.3]}}": (*CHAIN, *PUBLISHED),
    "simulations: {mine: {left: [0.5, 0.3]}}": (*2 * CHAIN, *4 * ("join",), "sweep_mine"),
    "simulations: {mine: {chunks: 1}}": (*CHAIN, "sweep_mine"),
    f"figures: {{{FIGURE}: {{thickness_ratios: [0.3, 1.0]}}}}": ("study_of_damage_zone", FIGURE),
    "scenes: {barrier: {title: Uno}}": SCENES,
    "claims: {front_speed: {tolerance: 0.5}}": (),
    "allow_large: true": (),
}


@pytest.mark.slow
@pytest.mark.parametrize("change", CONFIGURATIONS)
def test_another_configuration_runs_only_its_chain(imitated, change):
    assert jobs_after(imitated, change) == Counter([*CONFIGURATIONS[change], *ALWAYS])


SKETCHES = {"fig01_system_sketch", FIGURE, "study_barriers", "compile_kernels"}
DAMPED, HELD = "fig10_damping_displacement", "fig08_steady_state_displacement"
# Examples of studies, all of which run in one rule. The first two read different parts of
# `measure`, one of them also the model, and the last reads no settings.
STUDIES = {"study_of_extremes", "study_of_regime_plane", "study_of_layer"}
# A change, some of the rules that then run, and rules that do not run.
CHANGES = {
    "fraction": (
        "measure: {fraction: 0.9}",
        {"measure", "study_grid", "draw_scene", "write_claims", "fig05_scaling"},
        SKETCHES | STUDIES | {"simulate", "animate_scene", "fig06_burridge_knopoff", HELD, DAMPED},
    ),
    "damping ratio": (
        "model: {damping_ratio: 0.2}",
        {"measure", "study_grid", "simulate", "animate_scene", "fig04_space_time"},
        # The simulations of this figure set their own damping ratios.
        SKETCHES | STUDIES - {"study_of_regime_plane"} | {DAMPED},
    ),
    "coarser lattices": (
        "presets: {draft: {coarser: [2.0, 3.0]}}",
        {"study_grid", "draw_scene"},
        {"simulate", "measure"},
    ),
    "prediction": (
        "src/slippulse/prediction/predicted_pulse.py",
        {"predict", "sweep_mine", "draw_scene", HELD},
        {"fig02_phase_diagram", "fig05_scaling", "study_front_speed", "study_arrest"},
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize(("change", "readers", "untouched"), CHANGES.values(), ids=CHANGES)
def test_a_shared_value_or_topic_runs_its_readers_alone(imitated, change, readers, untouched):
    jobs = set(jobs_after(imitated, change))
    assert readers | ALWAYS <= jobs and not untouched & jobs and untouched <= RULES
