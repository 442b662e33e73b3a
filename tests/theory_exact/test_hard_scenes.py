"""No answer on random hard scenes owes anything to scale, direction, duration or panels."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from hard_scenes import FAMILIES, VARIANTS, Compared, scene
from tolerances import NUDGED, NUDGED_DOUBLE

from slippulse.theory import part
from slippulse.theory.lower_bound import stays_positive

# The first scenes are in each run of the tests, each with one variant; all with the slow tests.
FAST, ALL = 50, 500
# Scenes in which something sticks.
STICK = (13, 16, 23, 28, 37, 41)


@pytest.mark.parametrize("number", range(FAST))
def test_two_solutions_agree_before_either_has_a_limit(number):
    compared = Compared(scene(number))
    variant = list(VARIANTS)[number // len(FAMILIES) % len(VARIANTS)]
    other = compared.answers_of(VARIANTS[variant](compared.keys))
    assert compared.faults(other) == [], variant


@pytest.mark.parametrize("number", STICK)
def test_a_first_stick_is_known_as_soon_as_it_has_come(number):
    """A smooth minimum or a kink of the trailing edge, before there is a knot on either side."""
    keys = scene(number)
    first = keys.rupture().first_stick.time
    for after in (1e-7, 1e-3):
        found = replace(keys, duration=first * (1.0 + after)).rupture().first_stick
        assert found is not None, after
        assert found.time == pytest.approx(first, rel=NUDGED), after
    assert replace(keys, duration=first * (1.0 - 1e-8)).rupture().first_stick is None


def test_an_edge_as_steep_as_waves_is_slow_and_not_a_jump_in_each_of_its_pieces():
    """Its slopes say that it outruns the waves, by less than they err."""
    keys = scene(156)
    limit, finer = (replace(keys, refinement=n).rupture().limit for n in (1, 3))
    assert finer.time == pytest.approx(limit.time, rel=NUDGED)


@pytest.mark.parametrize("number", STICK)
def test_what_is_bounded_above_zero_is_so_in_between(number):
    """Where the bound holds, 15 positions in between slide until the first stick."""
    rupture = scene(number).rupture()
    time = 0.97 * rupture.first_stick.time
    part = next(p for p in rupture._solved if p.curve.covers(rupture.first_stick.x))
    fronts = (part.curve.front_at(time, rupture.first_stick.x, side) for side in (-1.0, 1.0))
    x = np.linspace(*fronts, 121)
    velocity = part.velocity(x, np.full(x.size, time))
    pairs, at_ends = (np.array([values[:-1], values[1:]]) for values in (x, velocity))
    bounded = stays_positive(part, pairs, at_ends, time)
    assert bounded.mean() > 0.5
    inner = np.linspace(*pairs[:, bounded], 17)[1:-1].ravel()
    assert np.min(part.velocity(inner, np.full(inner.size, time))) > 0.0
    # No pair around what has stuck is bounded.
    middle = np.array([[rupture.first_stick.x - 0.01], [rupture.first_stick.x + 0.01]])
    later = 1.01 * rupture.first_stick.time
    velocity = part.velocity(middle.ravel(), np.full(2, later))
    assert not stays_positive(part, middle, velocity[:, None], later).any()


@pytest.mark.parametrize("number", [39, 53, 59])
def test_without_leaf_springs_no_answer_owes_anything_to_the_scale(number, monkeypatch):
    """The scale of a part is a fraction of the duration then."""
    keys = scene(number)
    assert keys.gamma == 0.0
    compared = Compared(keys)
    one, fraction = compared.answers, part.SCALE_WITHOUT_SPRINGS
    for factor in (1.0 / 3.0, 3.0):
        monkeypatch.setattr(part, "SCALE_WITHOUT_SPRINGS", factor * fraction)
        two = compared.answers_of(keys)
        for name in ("release", "stick", "first", "slip"):
            expected = pytest.approx(getattr(one, name), rel=NUDGED, abs=NUDGED, nan_ok=True)
            assert getattr(two, name) == expected, name
        assert two.limit == pytest.approx(one.limit, rel=NUDGED_DOUBLE)


@cache
def all_variants(number: int) -> tuple[dict[str, list[str]], bool]:
    """Faults by variant, and whether refinement removes a limit: six solutions of a scene."""
    compared = Compared(scene(number))
    others = {name: compared.answers_of(change(compared.keys)) for name, change in VARIANTS.items()}
    removed = np.isfinite(compared.answers.limit) and np.isinf(others["refinement 2"].limit)
    return {name: compared.faults(other) for name, other in others.items()}, bool(removed)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(ALL))
def test_all_solutions_agree_before_either_has_a_limit(number):
    found, _ = all_variants(number)
    assert not any(found.values()), found


@pytest.mark.slow
def test_few_limits_are_removed_by_refinement():
    removed = [all_variants(number)[1] for number in range(ALL)]
    assert sum(removed) <= 0.15 * ALL
