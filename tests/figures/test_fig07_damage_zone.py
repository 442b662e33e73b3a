"""Figure 7: one stress through zone and rock, and the stress drop that follows."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest

from slippulse.data.store import load_table, save_table
from slippulse.figures import fig07_damage_zone as figure

SETTINGS = {
    "stiffness_ratios": {"from": 1e-4, "to": 2.0, "count": 31},
    "thickness_ratios": [0.5, 2.0, 8.0],
}


@pytest.fixture(scope="module")
def panels(tmp_path_factory):
    path = tmp_path_factory.mktemp("table") / "table.csv"
    save_table(figure.table({}, {}, SETTINGS), path)
    return figure.plot(load_table(path)).axes


def strains(profile):
    """Strains of zone and rock, from the drawn line."""
    x, y = profile.get_data()
    return np.diff(x) / np.diff(y)


def test_one_stress_goes_through_both_layers(panels):
    lines = {line.get_gid(): line for line in panels[0].lines}
    for name in ("before", "after"):
        zone, rock = strains(lines[name])
        assert figure.STIFFNESS_RATIO * zone == pytest.approx(rock)
    drop = strains(lines["before"])[0] - strains(lines["after"])[0]
    assert drop == pytest.approx(figure.SLIP / (1.0 + figure.STIFFNESS_RATIO * figure.ROCK))


def test_the_fault_slips_and_the_far_boundary_does_not(panels):
    lines = {line.get_gid(): line for line in panels[0].lines}
    before, after = (lines[name].get_xdata() for name in ("before", "after"))
    assert before[-1] == pytest.approx(after[-1])
    assert after[0] - before[0] == pytest.approx(figure.SLIP)
    assert before[0] == pytest.approx(lines["origin"].get_xdata()[0])
    boxes = {patch.get_gid(): patch for patch in panels[0].patches}
    interface = boxes["damage zone"].get_y() + boxes["damage zone"].get_height()
    assert interface == boxes["host rock"].get_y() == after_height(lines)
    written = " ".join(text.get_text() for text in panels[0].texts)
    for symbol in (r"\delta", r"\hat u", "$H$", "$H_r$", "$G$", "G_r", "H + H_r"):
        assert symbol in written


def after_height(lines):
    """Height of the kink of the displacement."""
    return lines["after"].get_ydata()[1]


def test_stress_drop_follows_the_closed_form_below_its_limit(panels):
    curves = [line for line in panels[1].lines if line.get_gid() == "curve"]
    (limit,) = (line for line in panels[1].lines if line.get_gid() == "limit")
    assert panels[1].get_xscale() == "log"
    assert limit.get_ydata() == pytest.approx([1.0, 1.0])
    assert len(curves) == len(SETTINGS["thickness_ratios"])
    for line, thickness in zip(curves, SETTINGS["thickness_ratios"], strict=True):
        x, y = line.get_data()
        assert x.size == SETTINGS["stiffness_ratios"]["count"]
        assert x[[0, -1]] == pytest.approx([1e-4, 2.0])
        assert y == pytest.approx(1.0 / (1.0 + thickness * x), rel=1e-6)
        assert f"{thickness:g}" in line.get_label()
    assert all((upper.get_ydata() > lower.get_ydata()).all() for upper, lower in pairwise(curves))
    assert panels[1].get_xlabel() and panels[1].get_ylabel()
