"""Solve the scenes of one simulation exactly. Runs on lattices do not depend on this step."""

from functools import partial

from ..simulation.continuum import solve_exactly
from .simulate import simulate

run = partial(simulate, solve_exactly)
