"""Tabulate the stress drop of a fault with a soft damage zone, before and after slip."""

import numpy as np
import pandas as pd

from slippulse.theory.dimensional import damage_zone_stress_drop

NEEDS = {"settings": ["figures.fig07_damage_zone"]}

# The example of the sketch, in units of the thickness of the damage zone.
ROCK_THICKNESS = 1.6
SLIP = 1.1
IMPOSED_DISPLACEMENT = 1.9
STIFFNESS_RATIO = 0.2  # G/G_r


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of three parts of the figure, which the column role names.

    The formulas are those of section IV C 2 of the paper.

    curve : stress drop by ratio of stiffness, for several thicknesses of the rock
    before, after : displacement by height y in the example of the sketch, before and after slip
    """
    figure = settings["figures"]["fig07_damage_zone"]
    steps = figure["stiffness_ratios"]
    ratios = np.geomspace(steps["from"], steps["to"], steps["count"])
    parts = [curve(float(thickness), ratios) for thickness in figure["thickness_ratios"]]
    parts.append(displacements(0.0).assign(role="before"))
    parts.append(displacements(SLIP).assign(role="after"))
    return pd.concat(parts, ignore_index=True)


def curve(thickness: float, stiffness_ratios: np.ndarray) -> pd.DataFrame:
    """Return the stress drop by ratio of stiffness, for one thickness of the rock.

    The slip, and the thickness and shear modulus of the damage zone, are 1.
    """
    drop = damage_zone_stress_drop(
        slip=1.0,
        shear_modulus=1.0,
        rock_shear_modulus=1.0 / stiffness_ratios,
        thickness=1.0,
        rock_thickness=thickness,
    )
    columns = {"thickness_ratio": thickness, "stiffness_ratio": stiffness_ratios}
    return pd.DataFrame({"role": "curve"} | columns | {"stress_drop": drop})


def displacements(slip: float) -> pd.DataFrame:
    """Return the displacement at three heights: the fault, and the tops of damage zone and rock.

    The top of the rock has the imposed displacement.
    """
    # Both layers together are sheared by the imposed displacement minus the slip. Stress is
    # proportional to it with the same factor as the stress drop to the slip.
    stress = float(
        damage_zone_stress_drop(
            slip=IMPOSED_DISPLACEMENT - slip,
            shear_modulus=1.0,
            rock_shear_modulus=1.0 / STIFFNESS_RATIO,
            thickness=1.0,
            rock_thickness=ROCK_THICKNESS,
        )
    )
    # Both layers have the same stress, so strains are inversely proportional to the moduli.
    y = np.array([0.0, 1.0, 1.0 + ROCK_THICKNESS])
    relative_displacement = np.array([0.0, 1.0, 1.0 + STIFFNESS_RATIO * ROCK_THICKNESS])
    displacement = slip + stress * relative_displacement
    return pd.DataFrame({"role": "", "y": y, "displacement": displacement})
