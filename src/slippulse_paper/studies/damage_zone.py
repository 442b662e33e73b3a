"""Tabulate the stress drop of a fault with a soft damage zone, before and after slip."""

import numpy as np
import pandas as pd

from slippulse.theory.dimensional import damage_zone_stress_drop

NEEDS = {"settings": ["figures.fig07_damage_zone"]}

# The example of the sketch, in units of the thickness of the damage zone.
ROCK_THICKNESS = 1.6
SLIP = 1.1
IMPOSED_DISPLACEMENT = 1.9
# Shear modulus of the damage zone divided by that of the rock, G/G_r.
STIFFNESS_RATIO = 0.2


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the figure. The column ``role`` has these values:

    curve : stress drop as a function of the stiffness ratio, for several thicknesses of the rock
    before, after : displacement at heights y in the example of the sketch, before and after slip

    The formulas are those of section IV C 2 of the paper.
    """
    figure = settings["figures"]["fig07_damage_zone"]
    given = figure["stiffness_ratios"]
    stiffness_ratios = np.geomspace(given["from"], given["to"], given["count"])
    parts = []
    for rock_thickness in figure["thickness_ratios"]:
        parts.append(stress_drop_curve(float(rock_thickness), stiffness_ratios))
    parts.append(displacements("before", slip=0.0))
    parts.append(displacements("after", slip=SLIP))
    return pd.concat(parts, ignore_index=True)


def stress_drop_curve(rock_thickness: float, stiffness_ratios: np.ndarray) -> pd.DataFrame:
    """Return the stress drop of the fault as a function of the stiffness ratio.

    The slip is 1, and so are the thickness and the shear modulus of the damage zone.

    stiffness_ratios : shear moduli of the damage zone divided by that of the rock
    """
    drop = damage_zone_stress_drop(
        slip=1.0,
        shear_modulus=1.0,
        rock_shear_modulus=1.0 / stiffness_ratios,
        thickness=1.0,
        rock_thickness=rock_thickness,
    )
    columns = {"thickness_ratio": rock_thickness, "stiffness_ratio": stiffness_ratios}
    return pd.DataFrame({"role": "curve"} | columns | {"stress_drop": drop})


def displacements(role: str, slip: float) -> pd.DataFrame:
    """Return the displacement at three heights, after some slip.

    The heights are those of the fault, of the top of the damage zone and of the top of the rock.
    The top of the rock has the imposed displacement.
    """
    # The formula returns the stress for any displacement between bottom and top of both layers. For
    # a stress drop this displacement is the slip. In this figure, it is the imposed displacement
    # minus the slip.
    stress = float(
        damage_zone_stress_drop(
            slip=IMPOSED_DISPLACEMENT - slip,
            shear_modulus=1.0,
            rock_shear_modulus=1.0 / STIFFNESS_RATIO,
            thickness=1.0,
            rock_thickness=ROCK_THICKNESS,
        )
    )
    # Both layers have the same stress, so the strain of the rock is STIFFNESS_RATIO times that of
    # the damage zone. The shear modulus and the thickness of the damage zone are 1.
    y = np.array([0.0, 1.0, 1.0 + ROCK_THICKNESS])
    displacement_per_stress = np.array([0.0, 1.0, 1.0 + STIFFNESS_RATIO * ROCK_THICKNESS])
    displacement = slip + stress * displacement_per_stress
    return pd.DataFrame({"role": role, "y": y, "displacement": displacement})
