"""The grid study of a simulation by the textbook scheme: apart, as `simulate_fixed_step` is."""

from functools import partial

from ..solver.fixed_step import solve_by_scheme
from .study_grid import study

run = partial(study, solve_by_scheme)
