"""Every file of the package and of the report's texts marks the rules whose step reaches it, and no others."""

import html
import re

import pytest
import yaml
from dependencies import (
    EVERY_SOURCE,
    FILES,
    OVERLAY,
    PACKAGE,
    PROJECT,
    READ_BY,
    RULES,
    TEXTS,
    modules_of_rule,
    rules_of,
)
from pipeline_copy import copy_project, snakemake

from slippulse.steps.reach import sources

pytestmark = pytest.mark.workflow


@pytest.fixture(scope="module")
def inputs(tmp_path_factory) -> dict[str, set[str]]:
    """Files that each rule takes, from one look of Snakemake at everything."""
    folder = copy_project(PROJECT, tmp_path_factory.mktemp("dependencies"), link=True)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    targets = ("everything", "scenes", "results/predictions/own.csv")
    result = snakemake(folder, "--forceall", "--filegraph", "--", *targets, overlay="overlay.yaml")
    assert result.returncode == 0, result.stderr
    found = {}
    entry = r'point-size="18">(\w+)</font>(.*?)(?=point-size="18"|\Z)'
    for name, text in re.findall(entry, result.stdout, re.S):
        taken = text.partition("&#8618; input")[2].partition("output &rarr;")[0]
        found[name] = {html.unescape(file) for file in re.findall(r'"monospace">([^<]+)<', taken)}
    return found


@pytest.fixture(scope="module")
def seen(inputs) -> dict[str, set[str]]:
    """Sources that each rule depends on: what its modules reach, and the texts that it takes."""
    return {
        name: {file for file in files if not file.startswith(("results/", "<"))}
        | {*sources(*modules_of_rule(name))}
        for name, files in inputs.items()
        if name not in ("all", "everything", "scenes")
    }


def test_the_rules_are_one_a_step_a_figure_and_a_study(seen):
    """And `draw_figure` and `run_study` are the steps of the last two."""
    assert set(seen) == RULES


def test_every_file_marks_the_rules_whose_step_reaches_it(seen):
    marked = {file: {rule for rule, inputs in seen.items() if file in inputs} for file in FILES}
    reaching = {file: rules_of(file) for file in FILES}
    wrong = [
        f"{file}: {sorted(marked[file] - reaching[file])} too many, {sorted(reaching[file] - marked[file])} missing"
        for file in FILES
        if marked[file] != reaching[file]
    ]
    assert len(FILES) > 150
    assert not wrong, f"{len(wrong)} of {len(FILES)} files mark other rules:\n" + "\n".join(wrong)


def test_no_rule_depends_on_another_file_of_the_sources(seen):
    others = {rule: inputs - set(FILES) for rule, inputs in seen.items() if rule not in EVERY_SOURCE}
    others = {rule: extra for rule, extra in others.items() if extra}
    # The report says what differs from the shipped configuration, and its version.
    assert others == {"write_report": {"CITATION.cff", "config/config.yaml"}}
    workflow = {"Snakefile", "workflow/rules/common.smk"}
    assert workflow <= seen["write_provenance"]


def test_every_text_has_a_reader():
    assert {path.name for path in TEXTS.iterdir()} == set(READ_BY)


def test_a_module_is_taken_by_name_only_where_the_rule_names_it():
    """An import that is computed at run time is not seen in the text of a module."""
    found = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if re.search(r"\bimport_module\(|__import__\(", path.read_text(encoding="utf-8"))
    }
    assert found == {
        "__init__.py", "steps/draw_figure.py", "steps/job.py", "steps/predict.py",
        "steps/run_study.py", "theory/__init__.py",
    }  # fmt: skip


def test_checksums_and_manifest_cover_what_everything_makes_and_what_is_ones_own(inputs):
    listed = {file for file in inputs["write_provenance"] if file.startswith("results/")}
    about_itself = {"results/provenance.json", "results/index.html"}
    assert inputs["everything"] == listed | about_itself
    for name in ("own", "mine", "barrier"):
        assert f"results/data/{name}.nc" in listed
        assert {f"results/{kind}/{name}.csv" for kind in ("measurements", "uncertainties")} <= listed
    assert {f"results/scenes/mine.{ending}" for ending in ("html", "png", "pdf", "csv")} <= listed
    # Data of a figure and of a claim.
    assert {"results/data/steady_stress.nc", "results/measurements/scaling_stress.csv"} <= listed
