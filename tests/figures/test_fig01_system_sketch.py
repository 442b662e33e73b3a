"""Figure 1: geometry to scale, and the displacement that each boundary condition is reduced with."""

from __future__ import annotations

import numpy as np
import pytest

from slippulse.data.store import load_table, save_table
from slippulse.figures import fig01_system_sketch as figure

THICKNESS, STRIP = 2.0, 0.1


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    path = tmp_path_factory.mktemp("table") / "table.csv"
    save_table(figure.table({}, {}, {"thickness": THICKNESS, "strip_width": STRIP}), path)
    return load_table(path)


@pytest.fixture(scope="module")
def panels(rows):
    return dict(zip(figure.TITLES, figure.plot(rows).axes, strict=True))


def named(axes, name):
    """Patches of one name."""
    return [patch for patch in axes.patches if patch.get_gid() == name]


def test_the_settings_set_the_geometry(panels):
    for axes in panels.values():
        (strip,), (layer,), (substrate,) = (named(axes, name) for name in ("strip", "layer", "substrate"))
        assert strip.get_width() == pytest.approx(STRIP * THICKNESS)
        assert (strip.get_y(), strip.get_height()) == (0.0, THICKNESS)
        assert layer.get_x() < strip.get_x() < layer.get_x() + layer.get_width()
        assert substrate.get_y() + substrate.get_height() == pytest.approx(0.0)


def test_only_one_top_is_held_and_only_the_other_is_sheared(panels):
    assert not named(panels["stress"], "held top") and named(panels["stress"], "imposed stress")
    (held,) = named(panels["displacement"], "held top")
    assert held.get_y() == THICKNESS
    assert not named(panels["displacement"], "imposed stress")


def test_displacement_is_uniform_or_linear_with_half_the_slip_as_mean(panels):
    for panel, share in (("stress", 1.0), ("displacement", 0.5)):
        lines = {line.get_gid(): line for line in panels[panel].lines}
        slip = lines["profile"].get_xdata() - lines["rest"].get_xdata()[0]
        assert np.mean(slip) == pytest.approx(share * slip[0])
        assert lines["profile"].get_ydata()[[0, -1]] == pytest.approx([0.0, THICKNESS])
    assert slip[-1] == pytest.approx(0.0)


def test_friction_opposes_sliding_and_everything_has_a_name(rows, panels):
    friction = rows[(rows["role"] == "arrow") & (rows["name"] == "friction")]
    stress = rows[(rows["role"] == "arrow") & (rows["name"] == "imposed stress")]
    assert len(friction) == 2 and (friction["x_end"] < friction["x"]).all()
    assert (stress["x_end"] > stress["x"]).all() and (stress["y"] > THICKNESS).all()
    for axes in panels.values():
        written = " ".join(text.get_text() for text in axes.texts)
        for symbol in ("G", r"\lambda", "H", "f_f", r"\mu_s", r"\mu_k", r"\mathrm{d}x", "$x$", "$y$"):
            assert symbol in written
    assert any(r"\tau" in text.get_text() for text in panels["stress"].texts)
    assert any(r"\partial t = 0" in text.get_text() for text in panels["displacement"].texts)


def test_nothing_is_drawn_beyond_the_axes(rows, panels):
    for panel, axes in panels.items():
        part = rows[rows["panel"] == panel]
        for x, y in (("x", "y"), ("x_end", "y_end")):
            assert part[x].dropna().between(*axes.get_xlim()).all()
            assert part[y].dropna().between(*axes.get_ylim()).all()
