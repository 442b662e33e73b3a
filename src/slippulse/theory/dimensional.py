"""The stress drop of a fault with a compliant damage zone, in SI units."""

from .domains import broadcast_numbers

POSITIVE = {"above": 0.0}
DOMAINS = {
    "shear_modulus": POSITIVE,
    "rock_shear_modulus": POSITIVE,
    "thickness": POSITIVE,
    "rock_thickness": {"at_least": 0.0},
}


def damage_zone_stress_drop(slip, shear_modulus, rock_shear_modulus, thickness, rock_thickness):
    """Static stress drop of a fault with a compliant damage zone: section IV C 2 of the paper.

    It is G delta/(H + (G/G_r) H_r), in Pa, if a displacement is imposed far away on the rock.
    Raises ValueError: outside these ranges.

    Parameters
    ----------
    slip : float or array, delta (m)
    shear_modulus, rock_shear_modulus : floats or arrays, G of the zone and G_r of the rock (Pa),
        > 0
    thickness, rock_thickness : floats or arrays, H of the zone, > 0, and H_r of the rock, to the
        imposed displacement, >= 0 (m)

    Returns
    -------
    float or array : G delta/(H + (G/G_r) H_r) (Pa)

    Examples
    --------
    >>> damage_zone_stress_drop(1.0, 1e9, 3e10, 100.0, 3000.0) / 1e6
    5.0
    """
    moduli = {"shear_modulus": shear_modulus, "rock_shear_modulus": rock_shear_modulus}
    given = {"slip": slip, **moduli, "thickness": thickness, "rock_thickness": rock_thickness}
    slip, zone, rock, thickness, rock_thickness = broadcast_numbers(DOMAINS, **given)
    return zone * slip / (thickness + zone / rock * rock_thickness)
