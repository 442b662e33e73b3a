"""The exact rupture of a scene."""

from ..model.friction_laws.rate import LinearRate
from ..model.scene import Scene
from ..theory.rupture import Rupture


def exact_rupture(scene: Scene) -> Rupture:
    """The exact rupture of a scene in the limit dx -> 0 at its damping ratio."""
    rule, law = (scene.damping_ratio, scene.release), scene.friction
    alpha = law.alpha if isinstance(law, LinearRate) else 0.0
    return Rupture(scene.prestress, scene.gamma, *rule, scene.duration, rate_strengthening=alpha)
