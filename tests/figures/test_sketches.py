"""Figures 1 and 7: the sketches show what was computed."""

from itertools import pairwise

import numpy as np
import pytest

from slippulse.figures import fig01_system_sketch, fig07_damage_zone
from slippulse.studies import damage_zone

SPAN, THICKNESSES = {"from": 1e-4, "to": 2.0, "count": 31}, [0.5, 2.0, 8.0]


def named(axes, gid: str) -> list:
    """What is drawn under one name."""
    return [artist for artist in (*axes.patches, *axes.lines) if artist.get_gid() == gid]


def texts(axes) -> str:
    return " ".join(text.get_text() for text in axes.texts)


def test_only_one_top_is_held_and_the_reductions_are_those_of_the_paper():
    """Under a stress the mean stands for the interface; held, the mean of the displacement is half of the slip."""
    table = fig01_system_sketch.table({}, {}, {"thickness": 2.0, "strip_width": 0.1})
    assert table["strip_width"].iloc[0] == 0.2 and table["y"].max() == 2.0
    stress, held = fig01_system_sketch.plot(table).axes
    assert named(stress, "imposed stress") and not named(stress, "held top")
    assert named(held, "held top") and not named(held, "imposed stress")
    for axes, mean in ((stress, 1.0), (held, 0.5)):
        (line,) = named(axes, "displacement")
        x, y = line.get_xdata() - fig01_system_sketch.REST, line.get_ydata()
        assert np.trapezoid(x, y) == pytest.approx(mean * x[0]) and list(y) == [0.0, 1.0]
        (strip,) = named(axes, "strip")
        assert (strip.get_width(), strip.get_height()) == pytest.approx((0.1, 1.0))
        (friction,) = named(axes, "friction")
        assert np.diff(friction.get_path().vertices[:2, 0])[0] < 0.0, "friction opposes sliding"
        for symbol in ("G", r"\lambda", "H", "f_f", r"\mu_s", r"\mu_k", r"\mathrm{d}x", "$x$", "$y$"):
            assert symbol in texts(axes)
    assert r"\tau" in texts(stress) and r"\partial t = 0" in texts(held)


@pytest.fixture(scope="module")
def zone():
    settings = {"figures": {"fig07_damage_zone": {"stiffness_ratios": SPAN, "thickness_ratios": THICKNESSES}}}
    table = fig07_damage_zone.table({}, {"damage_zone": damage_zone.table({}, {}, settings)}, {})
    return fig07_damage_zone.plot(table).axes


def test_one_stress_goes_through_both_layers_of_the_damage_zone(zone):
    before, after = (named(zone[0], name)[0].get_data() for name in ("before", "after"))
    for x, y in (before, after):
        soft, stiff = np.diff(x) / np.diff(y)
        assert damage_zone.STIFFNESS_RATIO * soft == pytest.approx(stiff)
    # The fault slips, the far boundary does not, and the drop of stress is the closed form.
    assert after[0][0] - before[0][0] == pytest.approx(damage_zone.SLIP)
    assert after[0][-1] == pytest.approx(before[0][-1])
    drop = (np.diff(before[0]) - np.diff(after[0]))[0]
    assert drop == pytest.approx(damage_zone.SLIP / (1.0 + damage_zone.STIFFNESS_RATIO * damage_zone.ROCK))
    for symbol in (r"\delta", r"\hat u", "$H$", "$H_r$", "$G$", "G_r", "H + H_r"):
        assert symbol in texts(zone[0])


def test_the_stress_drop_follows_the_closed_form_below_its_limit(zone):
    lines = named(zone[1], "curve")
    (limit,) = named(zone[1], "limit")
    assert set(limit.get_ydata()) == {1.0} and zone[1].get_xscale() == "log"
    for line, thickness in zip(lines, THICKNESSES, strict=True):
        x, y = line.get_data()
        assert x[[0, -1]] == pytest.approx([SPAN["from"], SPAN["to"]]) and x.size == SPAN["count"]
        assert y == pytest.approx(1.0 / (1.0 + thickness * x), rel=1e-6) and y.max() < 1.0
        assert f"{thickness:g}" in line.get_label()
    assert all((upper.get_ydata() > lower.get_ydata()).all() for upper, lower in pairwise(lines))
