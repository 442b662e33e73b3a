"""The grid study of a simulation by the exact scheme: apart, as `simulate_continuum` is."""

from functools import partial

from ..simulation.continuum import solve_exactly
from .study_grid import study

run = partial(study, solve_exactly)
