"""The plane of pre-stress levels in which regimes are drawn."""

import numpy as np
import pytest

from slippulse_paper.studies.regime_plane import corners_of_pulse_area


@pytest.mark.parametrize(("still_fraction", "area"), [(0.05, 0.05), (0.3, 0.64), (0.5, 0.99)])
def test_the_area_of_pulses_reaches_the_left_edge_of_the_plane(still_fraction, area):
    """Without damping at small levels, the ratio of the levels at the border is 2 s/(1 - 2 s).

    At a fraction s of 1/2 all ruptures are pulses.
    """
    left, right = corners_of_pulse_area(0.0, "total", still_fraction).T
    assert left.min() <= -1.0
    # The shoelace formula, cut off at the left edge.
    left = np.maximum(left, -1.0)
    measured = 0.5 * abs(np.sum(left * np.roll(right, 1) - np.roll(left, 1) * right))
    assert measured == pytest.approx(area, rel=0.15)
