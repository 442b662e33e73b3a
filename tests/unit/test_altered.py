"""Notes on what an altered configuration changed, on figures and in the terminal."""

import matplotlib.image
import pytest

from slippulse.plotting.style import new_panels, save_figure
from slippulse_paper.configuration.altered import Alterations
from slippulse_paper.configuration.read import read_config, read_overlay

SHIPPED = read_overlay("config/config.yaml")


def alterations(overlay: dict) -> Alterations:
    here = read_config(SHIPPED, [overlay], every_run=False)
    return Alterations(read_config(SHIPPED, every_run=False), here)


OVERLAYS = {
    "a default": ({"model": {"release": "elastic"}}, "altered: release = elastic"),
    "a list": ({"simulations": {"steady_displacement": {"gamma": [0.3]}}}, "altered: gamma = 0.3"),
    "a preset": ({"preset": "draft"}, ""),
    "a default that the sweep replaces": ({"model": {"damping_ratio": 0.05}}, ""),
    "another sweep": ({"simulations": {"scaling_stress": {"width": [2.0]}}}, ""),
}


@pytest.mark.parametrize(("overlay", "note"), OVERLAYS.values(), ids=OVERLAYS)
def test_a_note_names_what_differs_in_the_runs_of_a_figure(overlay, note):
    assert alterations(overlay).note(["steady_displacement"], []) == note


def test_a_note_names_altered_keys_that_a_figure_reads_and_nothing_else():
    altered = alterations({"figures": {"fig01_system_sketch": {"strip_width": 0.5}}})
    assert altered.note([], ["figures.fig01_system_sketch"]) == "altered: strip_width = 0.5"
    assert altered.note([], ["figures.fig07_damage_zone"]) == ""
    altered = alterations({})
    assert not altered.overridden_defaults() and not any(altered.changes_of.values())


def test_simulations_that_do_not_take_a_default_are_named():
    (line,) = alterations({"model": {"damping_ratio": 0.05}}).overridden_defaults()
    assert "model.damping_ratio = 0.05" in line
    names = line.rpartition(": ")[2].split(", ")
    assert "steady_displacement" in names and "scaling_displacement" not in names
    # A fixed beta replaces the ratio too.
    assert "front_speed_fixed_beta" in names


def test_a_note_makes_a_figure_higher_and_covers_nothing(tmp_path):
    heights = []
    for note in ("", "altered: b = 0.05", "altered: " + 40 * "b = 0.05, "):
        figure, (axes,) = new_panels(3.4, 2.0, "a")
        axes.set_xlabel("position $x$")
        save_figure(figure, tmp_path / "one.png", tmp_path / "one.pdf", note)
        heights.append(matplotlib.image.imread(tmp_path / "one.png").shape[0])
        if note:
            canvas = figure.canvas.get_renderer()
            (text,) = figure.texts
            assert not text.get_window_extent(canvas).overlaps(axes.get_tightbbox(canvas))
    assert heights[0] < heights[1] < heights[2]
