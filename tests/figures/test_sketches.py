"""Figures 1, 6 and 7 show the right lengths, and blocks at the positions of the runs."""

from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import slippulse as sp
from slippulse_paper.figures import fig01_system_sketch
from slippulse_paper.figures import fig06_burridge_knopoff as figure
from slippulse_paper.studies import damage_zone

SYMBOLS = ("G", r"\lambda", "H", "f_f", r"\mu_s", r"\mu_k", r"\mathrm{d}x", "$x$", "$y$")
texts = lambda axes: " ".join(text.get_text() for text in axes.texts)


def named(axes, gid: str) -> list:
    return [artist for artist in (*axes.patches, *axes.lines) if artist.get_gid() == gid]


def test_only_one_top_is_held_and_the_reductions_are_those_of_the_paper():
    """The mean displacement is the slip under a stress, and half of the slip under a held top."""
    table = fig01_system_sketch.table({}, {}, {"strip_width": 0.1})
    stress, held = fig01_system_sketch.draw(table).axes
    assert named(stress, "imposed stress") and not named(stress, "held top")
    assert named(held, "held top") and not named(held, "imposed stress")
    for axes, mean in ((stress, 1.0), (held, 0.5)):
        (line,) = named(axes, "displacement")
        x, y = line.get_xdata() - fig01_system_sketch.ZERO_DISPLACEMENT, line.get_ydata()
        assert np.trapezoid(x, y) == pytest.approx(mean * x[0]) and list(y) == [0.0, 1.0]
        (strip,) = named(axes, "strip")
        assert (strip.get_width(), strip.get_height()) == pytest.approx((0.1, 1.0))
        (friction,) = named(axes, "friction")
        assert np.diff(friction.get_path().vertices[:2, 0])[0] < 0.0, "friction opposes sliding"
        assert all(symbol in texts(axes) for symbol in SYMBOLS)
    assert r"\tau" in texts(stress) and r"\partial t = 0" in texts(held)


def test_one_stress_goes_through_both_layers_of_the_damage_zone(draw):
    sketch = draw("fig07_damage_zone").figure.axes[0]
    before, after = (named(sketch, name)[0].get_data() for name in ("before", "after"))
    for x, y in (before, after):
        soft, stiff = np.diff(x) / np.diff(y)
        assert damage_zone.STIFFNESS_RATIO * soft == pytest.approx(stiff)
    # The fault slips, the far boundary does not, and the drop of stress is the closed form.
    assert after[0][0] - before[0][0] == pytest.approx(damage_zone.SLIP)
    assert after[0][-1] == pytest.approx(before[0][-1])
    drop = (np.diff(before[0]) - np.diff(after[0]))[0]
    closed = damage_zone.SLIP / (1.0 + damage_zone.STIFFNESS_RATIO * damage_zone.ROCK_THICKNESS)
    assert drop == pytest.approx(closed)
    for symbol in (r"\delta", r"\hat u", "$H$", "$H_r$", "$G$", "G_r", "H + H_r"):
        assert symbol in texts(sketch)


def test_the_stress_drop_follows_the_closed_form_below_its_limit(draw, shipped):
    plane, shown = draw("fig07_damage_zone").figure.axes[1], shipped["figures"]["fig07_damage_zone"]
    span, lines, (limit,) = shown["stiffness_ratios"], named(plane, "curve"), named(plane, "limit")
    assert set(limit.get_ydata()) == {1.0} and plane.get_xscale() == "log"
    for line, thickness in zip(lines, shown["thickness_ratios"], strict=True):
        x, y = line.get_data()
        assert x[[0, -1]] == pytest.approx([span["from"], span["to"]]) and x.size == span["count"]
        assert y == pytest.approx(1.0 / (1.0 + thickness * x), rel=1e-6) and y.max() < 1.0
        assert f"{thickness:g}" in line.get_label()
    assert all((upper.get_ydata() > lower.get_ydata()).all() for upper, lower in pairwise(lines))


@pytest.fixture
def drawn(draw):
    """Return the runs, their table, and the axes of blocks and pre-stress of each panel."""
    made = draw("fig06_burridge_knopoff")
    first_strip, first, second_strip, second = made.figure.axes
    panels = (first, first_strip), (second, second_strip)
    return made.data, made.table, dict(zip(figure.ROW_DISTANCES, panels, strict=True))


def segments(axes, name):
    return [line.get_xydata() for line in named(axes, name)]


@pytest.mark.parametrize("name", figure.ROW_DISTANCES)
def test_blocks_and_springs_stand_where_the_slip_puts_them(drawn, name):
    _, rows, panels = drawn
    axes, strip = panels[name]
    part = rows[rows["panel"] == name].sort_values(["row", "x"])
    moved = part["x"] + part["scale"] * part["slip"]
    centres = np.sort([block.get_x() + 0.5 * figure.BLOCK_WIDTH for block in axes.patches])
    assert centres == pytest.approx(np.sort(moved))
    shown = [to_hex(block.get_facecolor()) for block in axes.patches]
    assert sorted(shown) == sorted(part["state"].map(figure.STATE_COLOURS).map(to_hex))
    distances = np.concatenate([np.diff(row) for _, row in moved.groupby(part["row"])])
    gaps = distances - figure.BLOCK_WIDTH
    coils = segments(axes, "coil springs")
    assert [coil[-1, 0] - coil[0, 0] for coil in coils] == pytest.approx(gaps)
    # No blocks overlap, and some springs are stretched.
    assert 0.0 < gaps.min() < 1.0 - figure.BLOCK_WIDTH < gaps.max()
    leaves = segments(axes, "leaf springs")
    if name == "displacement":
        assert np.sort([leaf[0, 0] for leaf in leaves]) == pytest.approx(np.sort(part["x"]))
        lean = np.sort([leaf[-1, 0] - leaf[0, 0] for leaf in leaves])
        assert lean == pytest.approx(np.sort(part["scale"] * part["slip"]))
    else:
        assert leaves == []
    first = part[part["row"] == 0]
    bars = [bar.get_height() for bar in strip.patches]
    assert bars == pytest.approx(first["prestress"].to_list())
    assert f"{first['scale'].iloc[0]:.2g}" in axes.get_xlabel()
    assert f"{first['left'].iloc[0]:g}" in strip.get_title()


def test_two_pulses_leave_the_held_plate_and_one_the_block_that_is_never_released(drawn):
    _, rows, panels = drawn
    last = rows[(rows["panel"] == "displacement") & (rows["instant"] == "two pulses")]
    assert np.array_equal(last["slip"], last["slip"].to_numpy()[::-1])
    states = ("sliding", "stuck after sliding")
    sliding, stuck = (last.loc[last["state"] == state, "x"].abs() for state in states)
    assert stuck.size and sliding.min() > stuck.max()
    assert not rows.loc[rows["panel"] == "displacement", "arresting_block"].any()
    part = rows[rows["panel"] == "stress"]
    last, framed = part[part["instant"] == "pulse"], part[part["arresting_block"]]
    sliding, stuck = (last.loc[last["state"] == state, "x"] for state in states)
    assert stuck.size and stuck.max() < sliding.min() and sliding.min() > 0.0
    assert framed["x"].nunique() == 1 and stuck.min() == framed["x"].iloc[0] + 1.0
    assert (framed["slip"] == 0.0).all() and (framed["prestress"] < 0.0).all()
    frames = [patch for patch in panels["stress"][0].patches if patch.get_linewidth() > 1.0]
    assert len(frames) == part["row"].nunique()


@pytest.mark.parametrize(
    ("level", "ticks"),
    [(0.15, {0.0, 1.0}), (0.3, {0.0, 0.3, 1.0}), (0.9, {0.0, 1.0}), (-0.7, {-0.7, 0.0, 1.0})],
)
def test_a_level_whose_number_would_overlap_another_one_has_no_tick(level, ticks):
    axes = Figure().subplots()
    blocks = pd.DataFrame({"x": [0.0, 1.0], "prestress": [level, 1.0], "left": level})
    figure.draw_prestress_strip(axes, blocks)
    assert set(axes.get_yticks()) == ticks


@pytest.mark.parametrize(("duration", "has_stopped"), [(3.0, False), (12.0, True)])
def test_only_a_front_that_has_stopped_is_drawn_as_stopped(duration, has_stopped):
    prestress = sp.Prestress(left=-0.7, right=0.0)
    numbers = {"dx": 1.0, "duration": duration, "max_step": 0.1, "resolved_blocks": 1}
    scene = sp.Scene(boundary="stress", prestress=prestress, **numbers)
    assert figure.left_front_has_stopped(sp.simulate(scene)) is has_stopped
