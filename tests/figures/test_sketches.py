"""Figures 1, 6 and 7: the sketches show what was computed."""

from __future__ import annotations

import numpy as np
import pytest


def test_the_strip_spans_the_layer(draw):
    drawn = draw("fig01_system_sketch")
    for axes in drawn.figure.axes:
        boxes = {patch.get_gid(): patch for patch in axes.patches if patch.get_gid()}
        assert boxes["strip"].get_height() == boxes["layer"].get_height() == drawn.settings["thickness"]
        assert boxes["substrate"].get_y() + boxes["substrate"].get_height() == pytest.approx(0.0)
    assert len(drawn.figure.axes) == 2


def test_the_held_top_does_not_move(draw):
    profiles = draw("fig01_system_sketch").table
    held = profiles[(profiles["panel"] == "displacement") & (profiles["role"] == "profile")]
    rest = profiles[(profiles["panel"] == "displacement") & (profiles["role"] == "rest")]["x"].iloc[0]
    assert held["x"].iloc[-1] == pytest.approx(rest)
    assert held["x"].iloc[0] > rest


def test_blocks_slide_where_the_run_slides(draw):
    drawn = draw("fig06_burridge_knopoff")
    rows = drawn.table
    last = rows[(rows["panel"] == "displacement") & (rows["row"] == rows["row"].max())]
    sliding = last[last["state"] == "sliding"]["x"].to_numpy()
    assert (sliding > 0.0).any() and (sliding < 0.0).any(), "two pulses"
    assert last[last["x"] == 0.0]["state"].iloc[0] == "stuck after sliding"
    assert np.allclose(np.sort(sliding), -np.sort(sliding)[::-1])

    last = rows[(rows["panel"] == "stress") & (rows["row"] == rows["row"].max())]
    sliding = last[last["state"] == "sliding"]["x"].to_numpy()
    assert sliding.size and (sliding > 0.0).all(), "one pulse"
    arresting = rows[rows["arresting_block"]]
    assert (arresting["slip"] == 0.0).all() and (arresting["x"] < 0.0).all()
    drawn_sliding = sum(patch.get_gid() == "sliding" for patch in drawn.figure.axes[1].patches)
    assert drawn_sliding > 0


def test_the_stress_drop_falls_with_the_stiffness_of_the_zone(draw):
    drawn = draw("fig07_damage_zone")
    lines = [line for line in drawn.figure.axes[1].lines if line.get_gid() == "curve"]
    assert len(lines) == len(drawn.settings["thickness_ratios"])
    previous = None
    for line, thickness in zip(lines, drawn.settings["thickness_ratios"], strict=True):
        x, y = line.get_data()
        assert (np.diff(y) < 0.0).all() and y.max() <= 1.0
        assert y == pytest.approx(1.0 / (1.0 + x * thickness), rel=1e-6)
        if previous is not None:
            assert (y <= previous).all()
        previous = y
