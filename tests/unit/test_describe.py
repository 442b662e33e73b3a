"""One definition of the keys: the JSON Schema and the tables of the manual are what follows from it."""

import re
import subprocess
import sys

import pytest
import yaml

from docs import describe


def test_every_key_of_the_definition_is_in_a_table(project):
    text = (project / describe.README).read_text(encoding="utf-8")
    for name, model in yaml.safe_load(describe.schema_text())["$defs"].items():
        for key in model["properties"]:
            assert re.search(rf"^\| `(\w+\.)*{key}` \|", text, re.MULTILINE), (name, key)


def test_schema_and_tables_are_those_of_the_definition_and_another_changes_both(
    project, tmp_path, monkeypatch
):
    paths = [describe.SCHEMA, describe.README, describe.SHIPPED]
    for path in paths:
        (tmp_path / path).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / path).write_bytes((project / path).read_bytes())
    describe.main(str(tmp_path))
    assert all((tmp_path / path).read_bytes() == (project / path).read_bytes() for path in paths)
    text = (project / describe.README).read_text(encoding="utf-8")
    assert (
        text.count("<!-- keys: ") == text.count("<!-- end of keys -->") == len(describe.TABLE.findall(text))
    )
    key = describe.json_schema()["$defs"]["Model"]["properties"]["release"]
    monkeypatch.setitem(key, "description", "something else")
    describe.main(str(tmp_path))
    assert "| `release` | something else |" in (tmp_path / describe.README).read_text(encoding="utf-8")
    assert "something else" in (tmp_path / describe.SCHEMA).read_text(encoding="utf-8")


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
