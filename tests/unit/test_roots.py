"""The root finders, compared with roots in closed form, and their refusals."""

import math

import numpy as np
import pytest

from slippulse.model.balance import root_to_last_bit
from slippulse.model.roots import root_between
from slippulse.theory.vector_roots import increasing_roots, roots_between

VALUES = np.array([0.1, 0.5, 2.0, 900.0])


def test_a_root_between_two_floats():
    assert root_between(lambda x: x**3 - 2.0, 0.0, 2.0) == pytest.approx(2.0 ** (1 / 3), abs=4e-12)
    with pytest.raises(ValueError):
        root_between(lambda x: x + 1.0, 0.0, 2.0)
    root = root_to_last_bit(lambda x: x * x - 2.0, 0.0, 2.0)
    assert root * root >= 2.0 > math.nextafter(root, 0.0) ** 2


def test_roots_of_many_functions_between_ends():
    lower, upper = np.zeros(4), np.full(4, 10.0)
    cubic = lambda x, which: x**3 - VALUES[which]
    roots = roots_between(cubic, lower, upper, -VALUES, 1000.0 - VALUES, 1e-12)
    assert roots == pytest.approx(np.cbrt(VALUES), abs=2e-12)
    with pytest.raises(ValueError, match="different signs"):
        roots_between(cubic, lower, upper, VALUES, VALUES, 1e-12)


def test_roots_of_increasing_functions_by_secants():
    sinh = lambda x, which: np.arcsinh(x) - np.arcsinh(VALUES[which])
    roots = increasing_roots(sinh, np.ones(4), np.zeros(4), np.full(4, 1e3))
    assert roots == pytest.approx(VALUES, rel=1e-13)
    with pytest.raises(ArithmeticError, match="no root"):
        increasing_roots(lambda x, which: np.full(x.size, np.nan), *np.ones((3, 4)))
