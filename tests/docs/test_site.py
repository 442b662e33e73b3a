"""The notebooks of the gallery and the code of the how-to pages run, and give what they say."""

import json
import re
import runpy

import numpy as np
import pytest

from docs import build_site
from slippulse_paper.configuration.read import read_config, read_overlay

GALLERY = build_site.PROJECT / "docs/gallery"
PYTHON = re.compile(r"^```python\n(.*?)^```", re.MULTILINE | re.DOTALL)


def displacement_held(names):
    times = names["times"]
    assert abs(times["lattice"] - times["exact"]) < names["scene"].dx
    assert times["paper"] == pytest.approx(times["exact"], rel=0.02)


def stress_held(names):
    # The lattice stops the front before the position that the continuum only tends to.
    assert 0.95 * names["predicted"] > names["stopped"] > names["predicted"]


def barrier(names):
    assert names["farthest"] - 22.0 == pytest.approx(names["depth"], rel=0.05)


def two_ruptures(names):
    assert names["meeting"] == pytest.approx(6.0, abs=names["scene"].dx)


def rough_fault(names):
    slip = float(names["slip"].mean())
    assert slip == pytest.approx(float(names["smooth"]), rel=0.1)


def strengthening_friction(names):
    without, with_it = names["without"], names["with_it"]
    assert with_it["pulse_slip"] < without["pulse_slip"]
    assert with_it["pulse_width"] > without["pulse_width"]
    assert with_it["front_speed_right"] < without["front_speed_right"]
    assert names["critical"] > 0.3


def laboratory_block(names):
    exact = names["sp"].theory.layer_results(names["layer"], 2.8e6, damping_ratio=0.1)["exact"]
    for name in ("front_speed_right", "pulse_width"):
        assert names["numbers"][name] == pytest.approx(exact[name], rel=0.02), name


def lattice_and_exact(names):
    assert np.all(np.abs(names["orders"] - 1.0) < 0.15)


SCENES = [displacement_held, stress_held, barrier, two_ruptures, rough_fault]
SCENES += [strengthening_friction, laboratory_block, lattice_and_exact]


@pytest.fixture(scope="module")
def run():
    return runpy.run_path(str(build_site.PROJECT / "docs/run_tutorial.py"))["run"]


@pytest.mark.parametrize("check", SCENES, ids=lambda check: check.__name__)
def test_a_notebook_of_the_gallery_shows_what_it_says(check, run, tmp_path):
    check(run(tmp_path, GALLERY / f"{check.__name__}.py"))


def test_every_notebook_is_in_the_gallery_and_tested():
    notebooks = {path.stem for path in GALLERY.glob("*.py")}
    listed = (GALLERY / "index.md").read_text(encoding="utf-8").splitlines()
    assert notebooks == {check.__name__ for check in SCENES} == notebooks & {*listed}


@pytest.mark.parametrize("name", ["index", "change_parameter", "friction_law"])
def test_the_code_of_a_page_runs(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (build_site.PROJECT / f"docs/{name}.md").read_text(encoding="utf-8")
    names: dict = {}
    for block in PYTHON.findall(text):
        exec(compile(block, name, "exec"), names)
    if name == "index":
        assert (tmp_path / "run.png").exists()
    if name == "change_parameter":
        assert names["finer"].damping_ratio == pytest.approx(0.1)
        assert len(names["times"]) == 4


def test_the_overlay_of_a_million_runs_is_accepted(shipped, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text = (build_site.PROJECT / "docs/million_runs.md").read_text(encoding="utf-8")
    [block] = PYTHON.findall(text)
    exec(block.replace("count, chunks = 1000, 100", "count, chunks = 5, 2"), {})
    overlay = json.loads((tmp_path / "mine.yaml").read_text(encoding="utf-8"))
    assert len(overlay["simulations"]["million"]["left"]) == 5
    config = read_config(shipped, [read_overlay(tmp_path / "mine.yaml")])
    assert config.simulations["million"].chunks == 2


def test_links_of_the_site_lead_to_pages_only():
    names = {"docs/cost.md", "docs/index.md", "config/README.md"}
    text = "[a](cost.md#limits) [b](../src) [c](../config/README.md) [d](#here) ![e](x.png)\n"
    text += "```\n[f](../src)\n```\n"
    found = build_site.with_site_links(text + "[g](../README.md)", "docs/x.md", names)
    assert found.startswith("[a](/docs/cost.md#limits) b [c](/config/README.md) [d](#here) ![e]")
    assert "[f](../src)" in found and found.endswith("[g](/index.md)")


def test_every_page_is_in_a_list_of_the_site():
    docs = build_site.PROJECT / "docs"
    lists = ("index.md", "howto.md", "reference.md", "development.md", "gallery/index.md")
    listed = "\n".join((docs / name).read_text(encoding="utf-8") for name in lists)
    for path in docs.glob("*.md"):
        line = rf"^(.*<)?(/docs/)?{path.stem}>?$"
        assert path.name == "index.md" or re.search(line, listed, re.MULTILINE), path
