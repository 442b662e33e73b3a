"""Every file of the package and of the report's texts marks the rules whose step reaches it, and no others."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

import grimp
import pytest
import yaml
from jinja2 import meta
from pipeline_copy import copy_project, snakemake

from slippulse.pages.render import PAGES

pytestmark = pytest.mark.workflow

PROJECT = Path(__file__).resolve().parents[2]
PACKAGE = PROJECT / "src/slippulse"
TEXTS = PROJECT / "manuscript"
LOCK = "requirements.lock"
# A sweep in chunks, so that the rules that join them are there too.
OVERLAY = {
    "simulations": {
        "own": {
            "boundary": "displacement", "left": [0.3, 0.5], "right": "same", "gamma": [0.65], "duration": {"time": 6.0},
            "spacing": {"scale": 4.0}, "record": ["fronts"], "chunks": 2,
        }
    }
}  # fmt: skip
# Rules whose step takes a module by name: one a figure, one a study of the solver.
DRAWN = {path.stem for pattern in ("fig*.py", "study_*.py") for path in (PACKAGE / "figures").glob(pattern)}
STUDIED = {
    f"study_of_{path.stem}": path.stem
    for path in (PACKAGE / "studies").glob("*.py")
    if re.search(r"^SETTINGS = ", path.read_text(encoding="utf-8"), re.M)
}
# Pages, by the rule that writes them: the template that each begins with.
PAGE_OF = {
    "draw_scene": "scene.html",
    "write_claims": "claims.html",
    "write_index": "index.html",
    "write_scenes_page": "scenes.html",
}
# Texts beside the package, by the rules that read them.
READ_BY = {
    "captions.yaml": {"write_report", "write_index"},
    "errata.yaml": {"write_report"},
    "metadata.yaml": {"write_report"},
    "references.bib": {"write_report"},
    "replication.md": {"write_report"},
    "shipped_verdicts.yaml": {"write_report"},
    "style.css": {"write_report"},
    "summary.yaml": {"write_index"},
    "template.typ": {"write_report"},
}
# Notes a digest of every source.
EVERY_SOURCE = {"write_provenance"}
FILES = sorted(
    path.relative_to(PROJECT).as_posix()
    for folder in (PACKAGE, TEXTS)
    for path in folder.rglob("*")
    if path.is_file() and "__pycache__" not in path.parts
)


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


@cache
def imports() -> grimp.ImportGraph:
    return grimp.build_graph("slippulse", cache_dir=None)


def module_file(name: str) -> str:
    path = PROJECT / "src" / Path(*name.split("."))
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    return path.relative_to(PROJECT).as_posix()


def is_lazy(name: str) -> bool:
    """Whether a package loads what it offers when that is used."""
    return "lazy_names(" in (PROJECT / module_file(name)).read_text(encoding="utf-8")


@cache
def reached_by(*modules: str) -> set[str]:
    """Files of all modules that some modules import, one through the other, the packages that they are in included."""
    graph, reached = imports(), set()
    pending = [f"slippulse.{name}" for name in modules]
    while pending:
        name = pending.pop()
        if name in reached:
            continue
        reached.add(name)
        if "." in name:
            pending.append(name.rpartition(".")[0])
        for imported in graph.find_modules_directly_imported_by(name):
            pending.append(imported)
            # What is taken from a package that loads as it goes may be in any of its modules.
            if imported != "slippulse" and is_lazy(imported):
                pending += graph.find_descendants(imported)
    return {module_file(name) for name in reached}


@cache
def templates_of(page: str) -> set[str]:
    """Templates that a page is made with."""
    source, _, _ = PAGES.loader.get_source(PAGES, page)
    found = {(PACKAGE / "pages/templates" / page).relative_to(PROJECT).as_posix()}
    for other in meta.find_referenced_templates(PAGES.parse(source)):
        found |= templates_of(other)
    return found


def expected(rule: str) -> set[str]:
    """Files of the package and texts that a rule depends on."""
    if rule in DRAWN:
        modules = ("steps.draw_figure", f"figures.{rule}")
    elif rule in STUDIED:
        modules = ("steps.run_study", f"studies.{STUDIED[rule]}")
    else:
        modules = (f"steps.{rule}",)
    found = reached_by(*modules)
    found |= templates_of(PAGE_OF[rule]) if rule in PAGE_OF else set()
    found |= {f"manuscript/{name}" for name, rules in READ_BY.items() if rule in rules}
    return found


def test_the_rules_are_one_a_step_a_figure_and_a_study(seen):
    """And `draw_figure` and `run_study` are the steps of the last two."""
    steps = {path.stem for path in (PACKAGE / "steps").glob("*.py")}
    steps -= {"__init__", "job", "reach", "draw_figure", "run_study"}
    assert set(seen) == steps | DRAWN | set(STUDIED)


def test_every_file_marks_the_rules_whose_step_reaches_it(seen):
    marked = {file: {rule for rule, inputs in seen.items() if file in inputs} for file in FILES}
    reached = {rule: expected(rule) for rule in seen}
    reaching = {file: {rule for rule in seen if file in reached[rule]} | EVERY_SOURCE for file in FILES}
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
