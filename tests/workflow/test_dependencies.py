"""Edits and altered values run the rules that depend on them, and no others."""

import html
import os
import re
from collections import Counter
from collections.abc import Iterable
from pathlib import Path

import grimp
import pytest
from pipeline_copy import edges, made, planned, snakemake
from rules_by_imports import DRAWN, EVERY_SOURCE, FILES, MODULES, PACKAGE, RULES, rules_of
from slippulse_paper.steps.reach import sources
from workflow.conftest import NAMES, TARGETS

from slippulse_paper.steps.predict import TOPICS

LOCK = "requirements.lock"
# One file of each folder: a test above covers them all.
EDITED = {Path(file).parent: file for file in FILES if Path(file).stem not in TOPICS}.values()


@pytest.fixture(scope="module")
def inputs(linked) -> dict[str, set[str]]:
    """Files that each rule takes, from one look of Snakemake at everything."""
    targets = (*TARGETS, "results/predictions/mine.csv")
    result = made(linked, "--forceall", "--filegraph", "--", *targets, overlay="overlay.yaml")
    files = {}
    entry = r'point-size="18">(\w+)</font>(.*?)(?=point-size="18"|\Z)'
    for name, text in re.findall(entry, result.stdout, re.S):
        taken = text.partition("&#8618; input")[2].partition("output &rarr;")[0]
        files[name] = set(map(html.unescape, re.findall(r'"monospace">([^<]+)<', taken)))
    return files


def test_every_file_marks_the_rules_whose_step_reaches_it_and_nothing_else_does(inputs):
    # Sources that each rule depends on: what its modules reach, and the texts that it takes.
    seen = {}
    for name in inputs.keys() - NAMES:
        # The folder of the sources only has a time.
        files = inputs[name] - {"src"}
        texts = {file for file in files if not file.startswith(("results/", "<"))}
        seen[name] = texts.union(sources(*MODULES[name]))
    # There is one rule a step, a figure and a study.
    assert set(seen) == RULES and len(FILES) > 150
    for file in FILES:
        assert {rule for rule, depends in seen.items() if file in depends} == rules_of(file), file
    # Predictions that two figures share do not stand in the module of one of them.
    for name in DRAWN:
        assert rules_of(f"src/slippulse_paper/figures/{name}.py") == {name} | EVERY_SOURCE
    others = {rule: depends.difference(FILES) for rule, depends in seen.items()}
    assert {"Snakefile", "workflow/rules/common.smk"} <= others.pop("write_index")
    # The report says what differs from the shipped configuration, and its version.
    assert others.pop("write_report") == {"CITATION.cff", "config/config.yaml"}
    assert not any(others.values())


def test_a_module_is_taken_by_name_only_where_the_rule_names_it():
    """An import that is computed at run time is not seen in the text of a module."""
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
    # Data of a figure and of a claim.
    assert {"results/data/steady_stress.nc", "results/measurements/scaling_stress.csv"} <= listed


@pytest.fixture(scope="module")
def downstream(imitated):
    """A function of some rules: these and all that take what they make, directly or not."""
    graph = ("--rulegraph", "mermaid-js", "--", *TARGETS)
    drawn = grimp.ImportGraph()
    for maker, taker in edges(snakemake(imitated, *graph, overlay="overlay.yaml").stdout):
        drawn.add_import(importer=taker, imported=maker)

    def find(rules: Iterable[str]) -> set[str]:
        known = drawn.modules.intersection(rules)
        return {*rules}.union(*map(drawn.find_downstream_modules, known)) - NAMES

    return find


def jobs_after(folder: Path, change: str = "{}") -> dict[str, int]:
    """Jobs of a dry run after an edit of a file or of some values, without those of names."""
    file, values = (change, "{}") if change in (*FILES, LOCK) else ("overlay.yaml", change)
    (folder / "values.yaml").write_text(values, encoding="utf-8")
    path = folder / file
    before, stat = path.read_bytes(), path.stat()
    try:
        path.write_bytes(before + b"\n# edited\n")
        overlays = ("overlay.yaml", "values.yaml")
        jobs = planned(snakemake(folder, "--dry-run", "--", *TARGETS, overlay=overlays))
    finally:
        path.write_bytes(before)
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    return {rule: count for rule, count in jobs.items() if rule not in NAMES}


@pytest.mark.slow
@pytest.mark.parametrize("file", (*EDITED, LOCK))
def test_an_edit_runs_what_depends_on_the_file(imitated, downstream, file):
    assert set(jobs_after(imitated, file)) == downstream(RULES if file == LOCK else rules_of(file))


# The whole configuration stands in the report and in the provenance, what an overlay alters on the
# pages; and a study draws the claims.
ALWAYS = {"write_claims", "study_open_choices", "write_report", "write_index"}
CHAIN = ("simulate", "measure", "predict", "study_grid")
PUBLISHED = ("study_published_figure", "study_of_exact_space_time", "study_of_derivations")
PUBLISHED += ("fig04_space_time",)
SCENES = ("draw_scene", "animate_scene", "write_scenes_page")
FIGURE = "fig07_damage_zone"
# Values that are laid over the configuration, and which jobs then run besides.
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
# They stand for all studies, which take what they read in one rule. The first two read other parts
# of `measure`, one of them the model too, and the last reads nothing.
STUDIES = {"study_of_extremes", "study_of_regime_plane", "study_of_layer"}
# A change, some of the rules that it marks, and rules that it does not mark.
SHARES = {
    "share": (
        "measure: {share: 0.9}",
        {"measure", "study_grid", "draw_scene", "write_claims", "fig05_scaling"},
        SKETCHES | STUDIES | {"simulate", "animate_scene", "fig06_burridge_knopoff", HELD, DAMPED},
    ),
    "damping ratio": (
        "model: {damping_ratio: 0.2}",
        {"measure", "study_grid", "simulate", "animate_scene", "fig04_space_time"},
        # Its simulations have damping ratios of their own.
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
@pytest.mark.parametrize(("change", "readers", "untouched"), SHARES.values(), ids=SHARES)
def test_a_shared_value_or_topic_runs_its_readers_alone(imitated, change, readers, untouched):
    jobs = set(jobs_after(imitated, change))
    assert readers | ALWAYS <= jobs and not untouched & jobs and untouched <= RULES
