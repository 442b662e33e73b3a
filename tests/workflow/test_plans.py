"""Jobs that Snakemake plans for the shipped targets, its graph and report, and its messages."""

import re
from itertools import pairwise

import pytest
from pipeline_copy import BY_PROFILE, edges, made, planned_by_name, snakemake
from rules_by_imports import DRAWN, STUDIED

FIGURE = "fig07_damage_zone"


@pytest.mark.slow
def test_the_default_is_the_whole_paper_and_a_figure_needs_only_its_simulations(linked):
    jobs = planned_by_name(snakemake(linked, "--dry-run"))
    pages = {"write_claims", "write_report", "write_index", "draw_scene"}
    assert pages | DRAWN | {*STUDIED} <= set(jobs)
    target = "results/figures/fig04_space_time.png"
    jobs = planned_by_name(snakemake(linked, "--dry-run", "--", target))
    once = dict.fromkeys(("compile_kernels", "fig04_space_time", "study_of_exact_space_time"), 1)
    assert jobs == once | {"simulate": 2, "measure": 2}


def test_a_draft_is_the_figures_and_what_an_overlay_adds(linked):
    """Only `everything` makes all studies, the shipped scenes, the claims and the report."""
    result = snakemake(linked, "--dry-run", overlay="overlay.yaml")
    jobs = planned_by_name(result)
    assert len([name for name in jobs if name.startswith("fig")]) == 11
    # Four simulations have grid studies since figures 5, 10 and 11 show their uncertainties.
    assert jobs["draw_scene"] == 1 and jobs["study_grid"] == 4 + 1
    drawn = {"damage_zone", "exact_space_time", "pulse_profiles", "regime_plane"}
    others = {name for name in jobs if name.startswith(("study_of", "write_"))}
    assert others == {f"study_of_{name}" for name in drawn}
    assert "Measuring mine/2-of-2" in result.stdout and "Drawing scene one" in result.stdout


@pytest.mark.slow
def test_the_graph_of_the_rules_shows_how_a_figure_and_the_claims_are_made(linked):
    targets = ("results/figures/fig05_scaling.png", "results/claims.json")
    drawn = edges(made(linked, "--rulegraph", "mermaid-js", "--", *targets).stdout)
    chain = ["compile_kernels", "simulate", "measure", "study_grid", "write_claims"]
    assert {*pairwise(chain), ("measure", "figure"), ("predict", "figure")} <= drawn


@pytest.mark.slow
def test_without_a_terminal_a_run_shows_one_short_line_a_job(linked):
    result = snakemake(linked, "--force", "--", f"results/figures/{FIGURE}.png", command=BY_PROFILE)
    output = result.stdout + result.stderr
    assert (
        result.returncode == 0 and len(re.findall(rf"draw_figure {FIGURE}: [0-9.]+ s", output)) == 1
    )
    assert "input:" not in output and len(output.splitlines()) < 40
    # The report is one file that loads no other files.
    made(linked, "--report", "report.html", "--", f"results/figures/{FIGURE}.png")
    text = (linked / "report.html").read_text(encoding="utf-8")
    assert '"Figures of the paper"' in text and FIGURE in text
    assert not re.findall(r"<(?:script|link|img)[^>]+(?:src|href)=.https?://", text)
