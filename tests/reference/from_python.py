"""Kernels that only kernels call, called from Python."""

from __future__ import annotations

from functools import cache

import numba


@cache
def from_python(kernel):
    """A function of Python that calls a kernel as another kernel would."""

    @numba.njit
    def call(*arguments):
        return kernel(*arguments)

    return call
