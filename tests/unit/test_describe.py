"""One definition of the keys: the JSON Schema and the tables of the manual are what follows from it."""

import re
import subprocess
import sys

import pytest
import yaml

from docs import describe
from slippulse.configuration.read import read_overlay


def test_the_schema_is_the_one_that_the_definition_makes(project):
    assert (project / describe.SCHEMA).read_text(encoding="utf-8") == describe.schema_text()


def test_the_tables_of_the_manual_are_those_that_the_definition_makes(project):
    text = (project / describe.README).read_text(encoding="utf-8")
    assert describe.readme(text, read_overlay(project / describe.SHIPPED)) == text
    assert (
        text.count("<!-- keys: ") == text.count("<!-- end of keys -->") == len(describe.TABLE.findall(text))
    )


def test_every_key_of_the_definition_is_in_a_table(project):
    text = (project / describe.README).read_text(encoding="utf-8")
    for name, model in yaml.safe_load(describe.schema_text())["$defs"].items():
        for key in model["properties"]:
            assert re.search(rf"^\| `(\w+\.)*{key}` \|", text, re.MULTILINE), (name, key)


def test_another_definition_changes_both(project, tmp_path, monkeypatch):
    for path in (describe.SCHEMA, describe.README, describe.SHIPPED):
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_bytes((project / path).read_bytes())
    describe.main(str(tmp_path))
    assert (tmp_path / describe.SCHEMA).read_bytes() == (project / describe.SCHEMA).read_bytes()
    key = describe.json_schema()["$defs"]["Model"]["properties"]["release"]
    monkeypatch.setitem(key, "description", "something else")
    describe.main(str(tmp_path))
    changed = (tmp_path / describe.README).read_text(encoding="utf-8")
    assert "| `release` | something else |" in changed


def test_the_schema_accepts_what_is_shipped(config):
    jsonschema = pytest.importorskip("jsonschema", reason="comes with Snakemake")
    jsonschema.validate(config, yaml.safe_load(describe.schema_text()))


def test_jobs_do_not_load_what_only_the_check_needs():
    program = (
        "import sys, slippulse.configuration.expand, slippulse.steps.simulate;"
        "print(sorted({'pydantic', 'ruamel.yaml', 'jsonschema'} & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
