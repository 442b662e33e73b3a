"""The pipeline as a user drives it: what a target needs, what a change re-runs, what is refused."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

import pytest
import yaml
from pipeline_copy import copy_project, planned
from pipeline_copy import snakemake as run_snakemake

pytestmark = pytest.mark.workflow

TARGETS = ["results/figures/fig07_damage_zone.png", "results/figures/fig08_steady_state_displacement.png"]
# Small enough to run in a second, large enough to have a pulse.
TINY = {
    "preset": "draft",
    "simulations": {
        "steady_displacement": {"left": [0.5, 0.7], "damping_ratio": [0.0, 0.1], "duration": {"time": 25.0}},
        "steady_stress": {"profiles": [{"left": -1.0, "right": 0.0, "width": 2.0}]},
    },
}


@pytest.fixture(scope="module")
def copy_of_project(project, tmp_path_factory) -> Path:
    """A copy of the project's sources, with a space and an umlaut in its path."""
    folder = copy_project(project, tmp_path_factory.mktemp("a copy für tests"))
    (folder / "tiny.yaml").write_text(yaml.safe_dump(TINY), encoding="utf-8")
    return folder


def snakemake(folder: Path, *arguments: str, config: str = "tiny.yaml") -> subprocess.CompletedProcess:
    """Run Snakemake in a folder on two cores."""
    return run_snakemake(folder, *arguments, overlay=config, cores=2)


@pytest.fixture(scope="module")
def finished(copy_of_project) -> Path:
    """The copy after its targets have been made."""
    result = snakemake(copy_of_project, "--", *TARGETS)
    assert result.returncode == 0, result.stderr
    for target in TARGETS:
        for ending in ("png", "pdf", "csv"):
            assert (copy_of_project / target).with_suffix(f".{ending}").stat().st_size > 0
    return copy_of_project


def test_everything_is_eleven_figures_in_three_files(copy_of_project):
    jobs = planned(snakemake(copy_of_project, "--dry-run", config=""))
    assert sum(name.startswith("fig") for name in jobs) == 11
    summary = snakemake(copy_of_project, "--summary", config="").stdout
    files = set(re.findall(r"results/figures/fig\d\d_\w+\.(?:pdf|png|csv)", summary))
    assert len(files) == 33


def test_a_draft_is_the_figures_unless_everything_is_asked_for(copy_of_project):
    draft = planned(snakemake(copy_of_project, "--dry-run", "--config", "preset=draft", config=""))
    whole = planned(
        snakemake(copy_of_project, "--dry-run", "--config", "preset=draft", "--", "everything", config="")
    )
    assert (
        sum(name.startswith("fig") for name in draft) == sum(name.startswith("fig") for name in whole) == 11
    )
    assert "write_report" in whole and "study_grid" in whole
    assert "write_report" not in draft and "study_grid" not in draft


def test_one_figure_needs_only_its_own_simulations(copy_of_project):
    jobs = planned(
        snakemake(copy_of_project, "--dry-run", "--", "results/figures/fig04_space_time.png", config="")
    )
    assert jobs["simulate"] == 2
    assert not any(name.startswith("fig") and name != "fig04_space_time" for name in jobs)


def edges(graph: str) -> set[tuple[str, str]]:
    """Which rule feeds which, by name, in a mermaid graph."""
    names = dict(re.findall(r"^\s*(id\d+)\[(\w+)\]", graph, re.M))
    return {(names[a], names[b]) for a, b in re.findall(r"^\s*(id\d+) --> (id\d+)", graph, re.M)}


def test_the_graph_in_the_readme_is_the_pipelines(copy_of_project, project):
    drawn = snakemake(
        copy_of_project, "--rulegraph", "mermaid-js", "--", "results/figures/fig05_scaling.png",
        "results/claims.json", config="",
    )  # fmt: skip
    assert drawn.returncode == 0, drawn.stderr
    shown = (project / "README.md").read_text(encoding="utf-8").split("```mermaid\n")[1].split("```")[0]
    assert edges(shown) == edges(drawn.stdout) and ("simulate", "measure") in edges(shown)


def test_a_second_run_does_nothing(finished):
    assert planned(snakemake(finished, "--dry-run", "--", *TARGETS)) == {}


def test_snakemakes_own_report_is_one_file_that_loads_nothing(finished):
    result = snakemake(finished, "--report", "report.html", "--", *TARGETS)
    assert result.returncode == 0, result.stderr
    text = (finished / "report.html").read_text(encoding="utf-8")
    assert '"Figures of the paper"' in text and "fig07_damage_zone" in text
    assert not re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=.https?://", text)


def test_another_level_runs_only_its_chain(finished):
    changed = {**TINY, "simulations": {**TINY["simulations"]}}
    changed["simulations"]["steady_displacement"] = TINY["simulations"]["steady_displacement"] | {
        "left": [0.5, 0.6]
    }
    (finished / "changed.yaml").write_text(yaml.safe_dump(changed), encoding="utf-8")
    jobs = planned(snakemake(finished, "--dry-run", "--", *TARGETS, config="changed.yaml"))
    assert jobs == {"simulate": 1, "measure": 1, "fig08_steady_state_displacement": 1}


def test_swapped_values_are_seen(finished):
    changed = {**TINY, "simulations": {**TINY["simulations"]}}
    changed["simulations"]["steady_displacement"] = TINY["simulations"]["steady_displacement"] | {
        "left": [0.7, 0.5]
    }
    (finished / "swapped.yaml").write_text(yaml.safe_dump(changed), encoding="utf-8")
    jobs = planned(snakemake(finished, "--dry-run", "--", *TARGETS, config="swapped.yaml"))
    assert jobs["simulate"] == 1


@pytest.mark.parametrize(
    ("source", "runs"),
    [
        ("src/slippulse/figures/fig07_damage_zone.py", {"fig07_damage_zone"}),
        (
            "src/slippulse/lattice/stencils.py",
            {"compile_kernels", "simulate", "measure", "fig08_steady_state_displacement"},
        ),
        ("src/slippulse/measure/pulses.py", {"measure", "fig08_steady_state_displacement"}),
        ("requirements.lock", {"compile_kernels", "simulate", "measure", "fig08_steady_state_displacement"}),
    ],
)
def test_an_edit_runs_what_uses_it(finished, source, runs):
    path = finished / source
    before = path.read_bytes()
    stat = path.stat()
    try:
        path.write_bytes(before + b"\n# edited\n")
        assert set(planned(snakemake(finished, "--dry-run", "--", *TARGETS))) == runs
    finally:
        path.write_bytes(before)
        os.utime(path, ns=(stat.st_atime_ns, stat.st_mtime_ns))


def test_equal_inputs_give_equal_bytes_on_one_core_and_two(finished):
    data = finished / "results/data/steady_displacement.nc"
    first = data.read_bytes()
    result = snakemake(
        finished, "--cores", "1", "--forcerun", "simulate", "--", str(data.relative_to(finished))
    )
    assert result.returncode == 0, result.stderr
    assert data.read_bytes() == first


@pytest.mark.parametrize(
    ("overlay", "named"),
    [
        ("simulations: {steady_displacement: {gama: [0.3]}}", ["gama", "did you mean 'gamma'"]),
        ("presets: {draft: {dx: 1e-3}}", ["presets.draft.dx", "'1e-3'", "1.0e-3"]),
        ("preset: best", ["preset", "'best'", "draft, paper, reference"]),
    ],
)
def test_a_mistake_is_refused_before_anything_runs(finished, overlay, named):
    (finished / "wrong.yaml").write_text(overlay, encoding="utf-8")
    result = snakemake(finished, "--forceall", "--", *TARGETS, config="wrong.yaml")
    text = result.stdout + result.stderr
    assert result.returncode != 0
    assert "Traceback" not in text
    for part in named:
        assert part in text
    assert "Simulating" not in text
