"""The grid study of a simulation by the exact scheme: apart, as `simulate_exact` is."""

from __future__ import annotations

from collections.abc import Mapping

from ..simulation.continuum import solve_scene
from .study_grid import study


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """As in `study_grid`."""
    study(solve_scene, files, outputs, settings)
