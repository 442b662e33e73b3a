"""The exact rupture of a scene, constructed by the theory."""

from ..model.scene import Scene
from ..theory.rupture import Rupture


def exact_rupture(scene: Scene) -> Rupture:
    """Return the exact rupture of a scene in the limit dx -> 0 at its damping ratio."""
    return Rupture(
        scene.prestress,
        scene.gamma,
        scene.damping_ratio,
        scene.release,
        scene.duration,
        rate_strengthening=scene.friction.traits.linear_rate,
    )
