"""The exact solution of a scene or of a finished run."""

import xarray as xr

from ..model.scene import scene_of
from ..theory.rupture import Rupture


def exact_rupture(run: xr.Dataset | dict) -> Rupture:
    """The exact solution of a run's scene, as `scene_of` takes it."""
    scene = scene_of(run)
    return Rupture(
        scene.prestress, scene.gamma, scene.damping_ratio, scene.release, scene.duration,
        rate_strengthening=scene.rate_strengthening,
    )  # fmt: skip
