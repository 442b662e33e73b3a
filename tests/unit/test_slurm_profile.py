"""The profile for a cluster: it names rules that exist, and every job asks for time and memory."""

import re
import tomllib

import yaml

RULE = re.compile(r"^rule (\w+):$(.*?)(?=^\S|\Z)", re.M | re.S)


def test_it_names_rules_that_exist_and_every_job_asks_for_time_memory_and_cores(project):
    paths = [project / "Snakefile", *(project / "workflow/rules").glob("*.smk")]
    rules = dict(RULE.findall("\n".join(path.read_text(encoding="utf-8") for path in paths)))
    path = project / "workflow/profiles/slurm/config.yaml"
    profile = yaml.safe_load(path.read_text(encoding="utf-8"))
    names = {*rules}
    shown = {"all", "compile_kernels", "simulate", "measure", "study_grid", "write_report"}
    assert shown | {"figure", "study"} <= names
    assert {*profile["set-resources"], *profile["groups"]} <= names
    for name in names:
        asked = profile["default-resources"] | profile["set-resources"].get(name, {})
        assert asked["cpus_per_task"] == "threads", name
        assert 1 <= asked["runtime"] <= 60, name
        # The largest job of the paper takes 480 MB; Snakemake, twice, is beside it.
        assert 700 <= asked["mem_mb"] <= 4000, name
    groups = profile["groups"]
    assert groups["simulate"] == groups["measure"] == groups["study_grid"]
    # In a group with them, the rule that joins the chunks would make one job of all.
    assert "join" in rules and "join" not in groups
    # A job that grows with the configuration asks by its cost, which the profile would hide.
    for name in ("simulate", "study_grid"):
        assert "**BOUNDS" in rules[name] and name not in profile["set-resources"], name


def test_the_plugin_is_in_its_own_lock_alone(project):
    text = lambda name: (project / name).read_text(encoding="utf-8")
    packages = lambda name: {*re.findall(r"^([\w.-]+)==", text(name), re.M)}
    cluster = packages("requirements-slurm.lock")
    assert {*tomllib.loads(text("pyproject.toml"))["dependency-groups"]["slurm"]} <= cluster
    assert not cluster & packages("requirements.lock")
