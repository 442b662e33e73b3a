"""Dimensional forms."""

from __future__ import annotations

import numpy as np


def damage_zone_stress_drop(slip, shear_modulus, rock_shear_modulus, thickness, rock_thickness):
    """Static stress drop of a fault with a compliant damage zone, sheared by a far imposed displacement.

    Parameters
    ----------
    slip : delta (m)
    shear_modulus : G of the damage zone (Pa)
    rock_shear_modulus : G_r of the host rock (Pa)
    thickness : H of the damage zone (m)
    rock_thickness : H_r of the host rock, between the zone and the imposed displacement (m)

    Returns
    -------
    float or array
        G delta / (H + (G/G_r) H_r) in Pa; G delta / H when G << G_r.

    Source: section IV C 2 of the paper.
    """
    slip = np.asarray(slip, dtype=float)
    ratio = np.asarray(shear_modulus, dtype=float) / np.asarray(rock_shear_modulus, dtype=float)
    return shear_modulus * slip / (thickness + ratio * rock_thickness)
