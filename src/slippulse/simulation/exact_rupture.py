"""The exact rupture of a scene."""

from ..model.scene import Scene, refuse_extra_terms
from ..theory.rupture import Rupture


def exact_rupture(scene: Scene) -> Rupture:
    """The exact rupture of a scene in the limit dx -> 0 at its damping ratio."""
    refuse_extra_terms(vars(scene), "for the exact rupture, which has no extra terms")
    rule = scene.damping_ratio, scene.release
    alpha = scene.friction.traits.linear_rate
    return Rupture(scene.prestress, scene.gamma, *rule, scene.duration, rate_strengthening=alpha)
