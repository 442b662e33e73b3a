"""Every file of the package and of the report's texts marks the rules whose step reaches it, and no others."""

from __future__ import annotations

import re

import pytest
import yaml
from dependencies import (
    EVERY_SOURCE,
    FILES,
    LOCK,
    OVERLAY,
    PACKAGE,
    PROJECT,
    READ_BY,
    RULES,
    STUDIED,
    TEXTS,
    rules_of,
)
from pipeline_copy import copy_project, snakemake

pytestmark = pytest.mark.workflow


@pytest.fixture(scope="module")
def seen(tmp_path_factory) -> dict[str, set[str]]:
    """Files that each rule has as inputs, results apart: all rules, from one look of Snakemake."""
    folder = copy_project(PROJECT, tmp_path_factory.mktemp("dependencies"), link=True)
    (folder / "overlay.yaml").write_text(yaml.safe_dump(OVERLAY), encoding="utf-8")
    result = snakemake(
        folder, "--forceall", "--filegraph", "--", "everything", "scenes", overlay="overlay.yaml"
    )
    assert result.returncode == 0, result.stderr
    found = {}
    for name, text in re.findall(
        r'point-size="18">(\w+)</font>(.*?)(?=point-size="18"|\Z)', result.stdout, re.S
    ):
        inputs = text.partition("&#8618; input")[2].partition("output &rarr;")[0]
        files = re.findall(r">((?:src|manuscript|workflow)/[^<]+|Snakefile|requirements\.lock)<", inputs)
        found[name] = {file.replace("&#45;", "-") for file in files}
    return {name: files for name, files in found.items() if name not in ("all", "everything", "scenes")}


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
    others = {
        rule: extra
        for rule, inputs in seen.items()
        if rule not in EVERY_SOURCE and (extra := inputs - set(FILES) - {LOCK})
    }
    assert not others
    workflow = {"Snakefile", "workflow/scripts/step.py", "workflow/rules/common.smk"}
    assert workflow <= seen["write_provenance"]


def test_what_computes_depends_on_the_packages_it_is_computed_with(seen):
    """The lock of versions; what only draws or measures does not begin anew with each of them."""
    computing = {"compile_kernels", "simulate", "study_grid", "write_report", "write_provenance", *STUDIED}
    assert {rule for rule, inputs in seen.items() if LOCK in inputs} == computing


def test_every_text_has_a_reader():
    assert {path.name for path in TEXTS.iterdir()} == set(READ_BY)


def test_a_module_is_taken_by_name_only_where_the_rule_names_it():
    """An import that is computed at run time is not seen in the text of a module."""
    found = {
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if re.search(r"\bimport_module\(|__import__\(|\blazy_names\(", path.read_text(encoding="utf-8"))
    }
    assert found == {
        "__init__.py", "lazy.py", "steps/draw_figure.py", "steps/job.py", "steps/run_study.py", "theory/__init__.py",
    }  # fmt: skip
