"""The files that describe environments and citation agree with the project and with each other."""

import json
import re
import subprocess
import tomllib

import pytest
import yaml


@pytest.fixture(scope="module")
def pyproject(project) -> dict:
    return tomllib.loads((project / "pyproject.toml").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def citation(project) -> dict:
    return yaml.safe_load((project / "CITATION.cff").read_text(encoding="utf-8"))


def test_the_archive_cites_what_the_citation_file_cites(project, pyproject, citation):
    archive = json.loads((project / ".zenodo.json").read_text(encoding="utf-8"))
    for key in ("title", "version", "license", "keywords"):
        assert archive[key] == citation[key], key
    assert archive["creators"] == citation["authors"]
    [paper] = citation["references"]
    assert paper["doi"] in {related["identifier"] for related in archive["related_identifiers"]}
    described = pyproject["project"]
    assert archive["version"] == described["version"] and archive["license"] == described["license"]
    assert archive["keywords"] == described["keywords"]


def test_the_site_says_how_to_cite(project, citation):
    text = (project / "docs/index.md").read_text(encoding="utf-8")
    [paper] = citation["references"]
    assert paper["doi"] in text and "CITATION.cff" in text
    assert all(author["family-names"] in text for author in paper["authors"])


def test_every_command_of_the_container_and_of_the_workflows_is_a_target(project):
    paths = [project / "Dockerfile", project / ".devcontainer/devcontainer.json"]
    paths += sorted((project / ".github/workflows").glob("*.yml"))
    makefile = (project / "Makefile").read_text(encoding="utf-8")
    for path in paths:
        text = path.read_text(encoding="utf-8")
        commands = re.findall(r"(?:RUN|run:|\"|&&) ?make ((?:[a-z][a-z-]*\b ?)+)", text)
        assert commands, path
        for target in {target for command in commands for target in command.split()}:
            assert re.search(rf"^{target}:", makefile, re.MULTILINE), (path.name, target)


def test_the_container_installs_from_the_locks_and_runs_both_commands(project):
    text = (project / "Dockerfile").read_text(encoding="utf-8")
    assert "requirements*.lock" in text and "pip install" not in text
    assert 'CMD ["sh", "-c", "make replicate && make test"]' in text
    container = json.loads((project / ".devcontainer/devcontainer.json").read_text("utf-8"))
    built = container["build"]
    assert (project / ".devcontainer" / built["dockerfile"]).resolve() == project / "Dockerfile"


def test_every_allowed_interpreter_is_tested_by_the_workflow(project, pyproject):
    text = (project / ".github/workflows/tests.yml").read_text(encoding="utf-8")
    jobs = yaml.safe_load(text)["jobs"]
    for job in ("tests", "library"):
        assert jobs[job]["strategy"]["matrix"]["python"] == ["3.11", "3.12", "3.13", "3.14"]
    assert {"system": "macos-latest", "python": "3.13"} in (
        jobs["tests"]["strategy"]["matrix"]["include"]
    )
    assert pyproject["project"]["requires-python"] == ">=3.11"


def test_the_script_for_interpreters_is_valid_shell(project):
    subprocess.run(["sh", "-n", project / "tests/interpreters.sh"], check=True)


@pytest.mark.parametrize("group", ["docs", "notebook", "slurm"])
def test_a_lock_of_a_group_agrees_with_the_lock_of_the_project(project, pyproject, group):
    text = (project / f"requirements-{group}.lock").read_text(encoding="utf-8")
    assert "--hash=sha256:" in text and "://" not in text
    pinned = set(re.findall(r"^([a-z0-9-]+)==", text, re.MULTILINE))
    shared = (project / "requirements.lock").read_text(encoding="utf-8")
    assert not pinned & set(re.findall(r"^([a-z0-9-]+)==", shared, re.MULTILINE))
    assert {*pyproject["dependency-groups"][group]} <= pinned
