"""The profile for a cluster: it parses, names rules that exist, and every job asks for time and memory."""

import re
import tomllib

import pytest
import yaml

RULE = re.compile(r"^rule (\w+):$(.*?)(?=^\S|\Z)", re.M | re.S)


@pytest.fixture(scope="module")
def rules(project) -> dict[str, str]:
    paths = [project / "Snakefile", *(project / "workflow/rules").glob("*.smk")]
    return dict(found for path in paths for found in RULE.findall(path.read_text(encoding="utf-8")))


@pytest.fixture(scope="module")
def profile(project) -> dict:
    return yaml.safe_load(
        (project / "workflow/profiles/slurm/config.yaml").read_text(encoding="utf-8")
    )


def test_it_names_rules_that_exist_and_every_job_asks_for_time_memory_and_cores(
    project, profile, rules
):
    # Rules made in a loop: one a figure.
    figures = project / "src/slippulse/figures"
    drawn = {path.stem for pattern in ("fig*.py", "study_*.py") for path in figures.glob(pattern)}
    assert {"all", "compile_kernels", "simulate", "measure", "study_grid", "write_report"} <= set(
        rules
    )
    assert {"fig01_system_sketch", "study_barriers"} <= drawn
    defaults, own = profile["default-resources"], profile["set-resources"]
    assert {*own, *profile["groups"]} <= set(rules) | drawn
    for name in set(rules) | drawn:
        asked = {**defaults, **own.get(name, {})}
        assert {"mem_mb", "runtime", "cpus_per_task"} <= set(asked), name
        assert asked["cpus_per_task"] == "threads", name
        assert 1 <= asked["runtime"] <= 60, name
        # The largest job of the paper takes 480 MB; Snakemake, twice, is beside it.
        assert 700 <= asked["mem_mb"] <= 4000, name


def test_a_sweep_or_chunk_is_one_job_the_joining_another_and_costs_are_asked_for(profile, rules):
    groups = profile["groups"]
    assert groups["simulate"] == groups["measure"] == groups["study_grid"]
    # In a group with them, the rule that joins the chunks would make one job of all.
    assert "join" in rules and "join" not in groups
    # What grows with the configuration asks by its cost.
    for name in ("simulate", "study_grid"):
        assert "**BOUNDS" in rules[name], name
        assert name not in profile["set-resources"], (
            f"{name}: the profile would hide what the rule asks for"
        )


def test_the_plugin_is_in_its_own_lock_alone(project):
    def packages(name: str) -> dict[str, str]:
        return dict(
            re.findall(r"^([\w.-]+)==([\w.]+)", (project / name).read_text(encoding="utf-8"), re.M)
        )

    everybody, cluster = packages("requirements.lock"), packages("requirements-slurm.lock")
    groups = tomllib.loads((project / "pyproject.toml").read_text(encoding="utf-8"))[
        "dependency-groups"
    ]
    assert set(groups["slurm"]) <= set(cluster)
    assert not set(cluster) & set(everybody)
