"""Figures may be asked for by less than their path."""

from __future__ import annotations

import runpy


def test_a_short_name_of_a_figure_is_understood(project, monkeypatch):
    monkeypatch.chdir(project)
    meant = runpy.run_path("workflow/run.py")["meant"]
    path = "results/figures/fig07_damage_zone.png"
    short = {
        "fig7": "fig07_damage_zone",
        "figure_07.png": path,
        path: path,
        "fig07_wrong.png": "fig07_wrong.png",
    }
    assert {name: meant(name) for name in short} == short
