"""Run the scenes of one simulation by the textbook scheme. Other runs do not depend on it."""

from functools import partial

from ..solver.fixed_step import solve_by_scheme
from .simulate import simulate

run = partial(simulate, solve_by_scheme)
