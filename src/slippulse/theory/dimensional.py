"""The stress drop of a fault with a compliant damage zone, in SI units."""

from ..model.checks import as_numbers


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
    >>> float(damage_zone_stress_drop(1.0, 1e9, 3e10, 100.0, 3000.0)) / 1e6
    5.0
    """
    zone = as_numbers("shear_modulus", shear_modulus, above=0.0)
    rock = as_numbers("rock_shear_modulus", rock_shear_modulus, above=0.0)
    height = as_numbers("thickness", thickness, above=0.0)
    rock_height = as_numbers("rock_thickness", rock_thickness, at_least=0.0)
    return zone * as_numbers("slip", slip) / (height + zone / rock * rock_height)
