"""Solve the scenes of one simulation exactly: apart, so that runs on lattices do not depend on the theory."""

from __future__ import annotations

from collections.abc import Mapping

from ..simulation.continuum import solve_scene
from .simulate import simulate


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """As in `simulate`."""
    simulate(solve_scene, outputs, settings)
