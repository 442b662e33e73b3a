"""The page on stress profiles in physical units, followed as a new user would."""

import re

import numpy as np
import pandas as pd
import pytest
import xarray as xr
import yaml
from pipeline_copy import copy_project, made

import slippulse as sp
from slippulse_paper.configuration.expand import expand
from slippulse_paper.configuration.read import read_config, read_overlay
from slippulse_paper.configuration.resolve import accuracy_of, resolve, scene_simulation


@pytest.fixture
def blocks(project):
    """The file maker, the overlay and the script of the page."""
    text = (project / "docs/stress_profile.md").read_text(encoding="utf-8")
    found = re.findall(r"^```(\w+)\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
    assert [language for language, _ in found] == ["python", "yaml", "python"]
    return [code for _, code in found]


def test_the_readme_has_the_overlay_of_the_page(blocks, project):
    readme = (project / "README.md").read_text(encoding="utf-8")
    block = re.search(r"^    scenes:\n(?:     .*\n)+", readme, re.MULTILINE)
    assert block and yaml.safe_load(block[0]) == yaml.safe_load(blocks[1])


def test_the_script_of_the_page_runs(blocks, tmp_path, monkeypatch, shipped):
    monkeypatch.chdir(tmp_path)
    maker, overlay, script = blocks
    exec(maker, {})
    assert len(pd.read_csv("stress.csv")) == 501
    names: dict = {}
    exec(script, names)
    assert (tmp_path / "rupture.png").stat().st_size > 20_000
    layer, run = names["layer"], names["run"]
    with xr.open_dataset("rupture.nc", engine="h5netcdf") as stored:
        assert stored["slip"].attrs["units"] == "m"
        assert sp.measure(stored)["first_stick_time"] == sp.measure(run)["first_stick_time"]
        assert layer.from_si(stored)["slip"].attrs["units"] == "1"
    # The overlay is the same scene.
    (tmp_path / "mine.yaml").write_text(overlay)
    config = read_config(shipped, [read_overlay("mine.yaml")])
    simulation = scene_simulation(config.scenes["my_rupture"], config.model, 0.01)
    (scene,), _ = expand(resolve(simulation, config.model, accuracy_of(config)))
    written = names["scene"].prestress
    assert np.allclose(scene.prestress.points, written.points, rtol=1e-12, atol=1e-12)
    for name in ("boundary", "gamma", "friction_ratio", "duration"):
        assert getattr(scene, name) == getattr(names["scene"], name)
    assert scene.dx == pytest.approx(names["scene"].dx, rel=1e-12)


@pytest.mark.slow
def test_figure_and_page_of_a_stress_file(blocks, project, tmp_path):
    folder = copy_project(project, tmp_path / "copy", link=True)
    maker, overlay, _ = blocks
    exec(maker.replace('"stress.csv"', repr(str(tmp_path / "stress.csv"))), {})
    (tmp_path / "mine.yaml").write_text(overlay)
    target = "results/scenes/my_rupture.html"
    made(folder, "--config", "preset=draft", "--", target, overlay=str(tmp_path / "mine.yaml"))
    page = (folder / target).read_text(encoding="utf-8")
    title = yaml.safe_load(overlay)["scenes"]["my_rupture"]["title"]
    for text in (title, "10 mm", "3 MPa", "60 \N{MICRO SIGN}s", "100 \N{MICRO SIGN}m"):
        assert text in page
    table = pd.read_csv((folder / target).with_suffix(".csv"))
    units = table[table["role"] == "unit"].set_index("series")["unit"]
    assert units["position"] == "mm" and units["stress"] == "MPa"
    drawn = table[table["role"] == "prestress"]
    x, stress = np.loadtxt(tmp_path / "stress.csv", delimiter=",", skiprows=2).T
    expected = np.interp(drawn["position"] / 1e3, x, stress)
    assert drawn["value"].to_numpy() * 1e6 == pytest.approx(expected, rel=1e-6)
