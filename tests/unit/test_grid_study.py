"""Grid studies and verdicts: the arithmetic behind every error bar."""

import numpy as np
import pytest

from slippulse.measure.uncertainty import grid_study


@pytest.mark.parametrize("order", [1.0, 2.0, 3.5])
@pytest.mark.parametrize("factors", [(2.0, 4.0), (1.5, 2.0)])
def test_a_power_of_the_spacing_is_recovered(order, factors):
    values = tuple(3.0 + 0.2 * factor**order for factor in (1.0, *factors))
    study = grid_study(values, factors)
    assert study.observed_order == pytest.approx(order, rel=1e-9)
    assert study.extrapolated == pytest.approx(3.0, rel=1e-12)
    assert study.uncertainty == pytest.approx(0.2, rel=1e-9)


def test_without_an_order_the_spread_is_the_uncertainty():
    study = grid_study((1.0, 1.1, 0.95), (2.0, 4.0))
    assert np.isnan(study.observed_order)
    assert study.uncertainty == pytest.approx(0.15)
    assert study.extrapolated == 1.0


def test_a_missing_coarse_value_leaves_no_uncertainty():
    assert np.isnan(grid_study((1.0, np.nan, 1.0), (2.0, 4.0)).uncertainty)
