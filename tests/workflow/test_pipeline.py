"""The pipeline as a user drives it: what a target needs, what the default makes, what the README shows."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
import yaml
from dependencies import STUDIED
from pipeline_copy import copy_project, edges, planned, snakemake

pytestmark = pytest.mark.workflow

OWN = {
    "preset": "draft",
    "simulations": {
        "mine": {
            "boundary": "displacement", "left": [0.5], "right": "same", "gamma": [0.65], "duration": {"time": 6.0},
            "spacing": {"scale": 4.0}, "record": ["fronts"],
        }
    },
    "scenes": {
        "one": {
            "title": "One", "boundary": "displacement", "left": 0.5, "right": 0.6, "gamma": 0.65, "dx": 0.1,
            "duration": 6.0,
        }
    },
}  # fmt: skip


@pytest.fixture(scope="module")
def folder(project, tmp_path_factory) -> Path:
    """A copy of the project's sources, with a space and an umlaut in its path."""
    folder = copy_project(project, tmp_path_factory.mktemp("a copy für tests"), link=True)
    (folder / "own.yaml").write_text(yaml.safe_dump(OWN), encoding="utf-8")
    return folder


def figures(jobs: dict[str, int]) -> int:
    return sum(name.startswith("fig") for name in jobs)


@pytest.mark.slow
def test_the_default_is_the_whole_paper(folder):
    jobs = planned(snakemake(folder, "--dry-run"))
    assert figures(jobs) == 11 and set(STUDIED) <= set(jobs)
    assert {"write_claims", "write_report", "write_provenance", "write_index", "draw_scene"} <= set(jobs)


def test_a_draft_is_the_figures_and_what_is_ones_own(folder):
    """Studies, the shipped scenes, the ledger and the report are made where everything is asked for."""
    jobs = planned(snakemake(folder, "--dry-run", overlay="own.yaml"))
    assert figures(jobs) == 11 and jobs["draw_scene"] == 1 and jobs["study_grid"] == 1
    drawn = {"damage_zone", "exact_space_time", "pulse_profiles", "regime_plane"}
    made = {name for name in jobs if name.startswith(("study_of", "write_"))}
    assert made == {f"study_of_{name}" for name in drawn}
    making = snakemake(folder, "--dry-run", overlay="own.yaml").stdout
    assert "Measuring mine" in making and "Drawing scene one" in making


@pytest.mark.slow
def test_one_figure_needs_only_its_own_simulations(folder):
    jobs = planned(snakemake(folder, "--dry-run", "--", "results/figures/fig04_space_time.png"))
    own = dict.fromkeys(("compile_kernels", "fig04_space_time", "study_of_exact_space_time"), 1)
    assert jobs == own | {"simulate": 2, "measure": 2}


@pytest.mark.slow
def test_the_graph_in_the_readme_is_the_pipelines(folder, project):
    targets = ("results/figures/fig05_scaling.png", "results/claims.json")
    drawn = snakemake(folder, "--rulegraph", "mermaid-js", "--", *targets)
    assert drawn.returncode == 0, drawn.stderr
    shown = (project / "README.md").read_text(encoding="utf-8").split("```mermaid\n")[1].split("```")[0]
    assert edges(shown) == edges(drawn.stdout) and ("simulate", "measure") in edges(shown)


@pytest.mark.slow
def test_a_run_shows_what_it_does_by_the_profile_of_the_folder(folder):
    """Without a terminal: one short line a job, and no pages of files and reasons."""
    target = "results/figures/fig07_damage_zone.png"
    command = [sys.executable, "-m", "snakemake", "--cores", "1", "--force", "--", target]
    result = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    said = result.stdout + result.stderr
    assert result.returncode == 0 and len(re.findall(r"fig07_damage_zone: [0-9.]+ s", said)) == 1
    assert "input:" not in said and len(said.splitlines()) < 40


@pytest.mark.slow
def test_snakemakes_own_report_is_one_file_that_loads_nothing(folder):
    target = "results/figures/fig07_damage_zone.png"
    assert snakemake(folder, "--", target).returncode == 0
    result = snakemake(folder, "--report", "report.html", "--", target)
    assert result.returncode == 0, result.stderr
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert '"Figures of the paper"' in text and "fig07_damage_zone" in text
    assert not re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=.https?://", text)
