"""Solve the scenes of one simulation exactly: apart, so that runs on lattices do not depend on the theory."""

from functools import partial

from ..simulation.continuum import solve_scene
from .simulate import simulate

run = partial(simulate, solve_scene)
