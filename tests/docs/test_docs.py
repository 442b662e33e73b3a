"""The definition of the keys, the tutorial and the reference agree; imports load what they need."""

import math
import re
import runpy
import subprocess
import sys
from pathlib import Path

import jsonschema
import pytest
import tolerances as tol
import yaml

import slippulse as sp
from docs import describe
from slippulse_paper.records.job_records import record_path
from slippulse_paper.steps.needs import needs_of


def test_the_tutorial_keeps_what_it_says(project, tmp_path):
    names = runpy.run_path(str(project / "docs/run_tutorial.py"))["run"](tmp_path)
    assert names["record"] == record_path(names["table"])
    assert len([*tmp_path.glob("*.png")]) == 3
    # Under a held stress the left front stops near where the paper has it, from below.
    balance = (1.5 + 1.0) / 0.5 * math.sqrt(math.pi / 2.0)
    assert 0.9 * balance < -names["stopped"] < 1.001 * balance
    # The lattice is near the exact solution.
    for error in ("stick_error", "slip_error"):
        assert 0.0 < names[error] < 2.0 * names["scene"].dx
    # Softer springs give more slip at the same speed.
    assert names["slip"]["soft"] > 1.5 * names["slip"]["stiff"]
    assert names["fronts"]["soft"] == pytest.approx(names["fronts"]["stiff"], rel=tol.FRONT_SPEED)
    # Slip without damping is the paper's.
    slips = [2.0 * tau / 0.65 for tau in names["levels"]]
    assert names["left_behind"] == pytest.approx(slips, rel=tol.FRONT_SPEED)
    assert names["relative_error"] < 1e-3
    # The first barrier is passed, and the second is not.
    edges = [position for position, _ in names["barrier"].steps]
    depth = sp.theory.barrier_depth(0.5, -0.5, gamma=0.65)
    (_, end), *_ = sp.theory.Rupture(names["barrier"], 0.65, duration=30.0).front_ends
    assert edges[1] - edges[0] < depth
    assert end.reason == "stops" and edges[2] < end.x < edges[2] + 1.1 * depth


def test_the_reference_explains_every_public_name(project, tmp_path):
    runpy.run_path(str(project / "docs/reference.py"))["main"](str(tmp_path))
    for package, page in ((sp, "slippulse.html"), (sp.theory, "slippulse/theory.html")):
        text = (tmp_path / page).read_text(encoding="utf-8")
        for name in set(package.__all__) - {"theory"}:
            assert f'id="{name}"' in text, name
            assert getattr(package, name).__doc__, name


def test_every_key_of_the_definition_is_in_a_table(project):
    text = (project / describe.README).read_text(encoding="utf-8")
    for name, model in yaml.safe_load(describe.schema_text())["$defs"].items():
        for key in model["properties"]:
            assert re.search(rf"^\| `(\w+\.)*{key}` \|", text, re.MULTILINE), (name, key)


def test_schema_and_tables_are_those_of_the_definition(project, config, tmp_path, monkeypatch):
    paths = [describe.SCHEMA, describe.README, describe.SHIPPED, describe.COLUMNS]
    for path in paths:
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_bytes((project / path).read_bytes())
    describe.main(str(tmp_path))
    assert all((tmp_path / path).read_bytes() == (project / path).read_bytes() for path in paths)
    text = (project / describe.README).read_text(encoding="utf-8")
    tables = len(describe.TABLE.findall(text))
    assert text.count("<!-- keys: ") == text.count("<!-- end of keys -->") == tables
    jsonschema.validate(config, yaml.safe_load(describe.schema_text()))
    key = describe.json_schema()["$defs"]["Model"]["properties"]["release"]
    monkeypatch.setitem(key, "description", "something else")
    describe.main(str(tmp_path))
    table, schema = ((tmp_path / path).read_text("utf-8") for path in paths[1::-1])
    assert "| `release` | something else |" in table and "something else" in schema


# Modules of a job of simulation and of Snakemake's plan, and libraries that they need not load.
UNLOADED = {
    "configuration.expand, slippulse_paper.steps.simulate": {
        "pydantic",
        "ruamel.yaml",
        "jsonschema",
    },
    "configuration.altered, slippulse_paper.records.sources": {
        "pandas",
        "xarray",
        "numba",
        "matplotlib",
    },
}


@pytest.mark.parametrize("modules", UNLOADED)
def test_nothing_is_loaded_that_is_not_needed(modules):
    loaded = f"sorted({UNLOADED[modules]} & set(sys.modules))"
    program = f"import sys, slippulse_paper.{modules}; print({loaded})"
    assert subprocess.check_output([sys.executable, "-c", program], text=True).strip() == "[]"


def test_the_files_from_a_key_to_a_pixel_have_what_the_page_names(project):
    text = (project / "docs/workflow.md").read_text(encoding="utf-8")
    section = text.partition("## From a key to a pixel")[2].partition("\n## ")[0]
    rows = re.findall(r"^\| `(\S+)` \| (?:`(\w+)`)? ?\|", section, re.MULTILINE)
    assert len(rows) == section.count("\n| ") - 1 > 10
    for path, name in rows:
        content = (project / path).read_text(encoding="utf-8")
        definition = rf"^\s*(def|rule) {name}\b|^{name} = "
        assert not name or re.search(definition, content, re.MULTILINE), (path, name)


# Modules that the recipes of CONTRIBUTING.md add.
ADDED = {"study_pulse_spacings.py", "test_foundation.py", "logarithmic_rate.py", "NAME.py"}


def test_modules_that_a_page_names_exist(project):
    files = subprocess.run(
        ["git", "ls-files", "*.py"], cwd=project, stdout=subprocess.PIPE, text=True, check=True
    )
    known = [f"/{path}" for path in files.stdout.splitlines()]
    pages = [*project.glob("*.md"), *project.glob("docs/*.md"), project / "config/README.md"]
    for page in pages:
        if page.name == "CHANGELOG.md":
            continue
        for name in re.findall(r"`([\w/]+\.py)`", page.read_text(encoding="utf-8")):
            exists = any(path.endswith(f"/{name}") for path in known)
            assert exists or Path(name).name in ADDED, (page.name, name)


def test_the_page_of_figures_has_every_figure_with_its_simulations(project):
    figures, studies = needs_of("figures"), needs_of("studies")
    page = (project / "docs/figures.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `(\w+)` \| .* \| ([^|]*) \|$", page, re.MULTILINE)
    assert {name for name, _ in rows} == {*figures}
    for name, simulations in rows:
        needed = [figures[name], *(studies[study] for study in figures[name].get("studies", ()))]
        kinds = ("data", "measured", "uncertainties", "sweeps")
        found = {one for needs in needed for kind in kinds for one in needs.get(kind, ())}
        assert set(re.findall(r"\w+", simulations)) == found, name
