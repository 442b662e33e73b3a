"""The exact rupture of a scene, constructed by the theory."""

from ..model.scene import Scene, refuse_extra_terms
from ..theory.rupture import Rupture


def exact_rupture(scene: Scene) -> Rupture:
    """Return the exact rupture of a scene in the limit dx -> 0 at its damping ratio.

    Raises ValueError if the scene uses an extra term, which the paper's equation does not have.
    """
    refuse_extra_terms(vars(scene), "for the exact rupture, which has no extra terms")
    return Rupture(
        prestress=scene.prestress,
        gamma=scene.gamma,
        damping_ratio=scene.damping_ratio,
        release=scene.release,
        duration=scene.duration,
        rate_strengthening=scene.friction.traits.linear_rate,
    )
