"""Errors of random scenes at a promised accuracy, relative to the exact solution, and their cost.

python tests/benchmark/promises.py ACCURACY FIRST COUNT MAX_STEPS prints rows of the table in
config/README.md. Scenes from number 1000 on have a barrier of negative pre-stress on both sides.
"""

import math
import sys
from dataclasses import dataclass

import numpy as np
import pandas as pd

import slippulse as sp
from slippulse.measurement.promise import judge_promises
from slippulse.measurement.table import PARAMETERS
from slippulse.measurement.uncertainty import grid_tables
from slippulse.model.stability import choose_step
from slippulse.prediction.comparison import measured_row
from slippulse.prediction.measured_run import MEASURE_SETTINGS

# The first three factors are the grid study. The others serve to find the cheapest spacing that is
# accurate enough.
SPACING_FACTORS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
# Scenes with at least this number of covered numbers have a pulse or a transition.
MIN_KEPT_NUMBERS = 5
KINDS = ["kept", "wrong", "missed", "missed_rightly", "unknown"]
COLUMNS = ["scene", "family", *KINDS, "cost", "not_kept"]
FIRST_BARRIER_SCENE = 1000
RATIOS = (0.0, 0.02, 0.05, 0.1, 0.3, 1.0)


def log_uniform(chance, low, high):
    """Return a random number between two limits whose logarithm is uniform."""
    return float(np.exp(chance.uniform(math.log(low), math.log(high))))


def uniform(chance, low, high):
    """Return a random number between two limits."""
    return float(chance.uniform(low, high))


def profile(left, right, width, *bumps):
    """Return a pre-stress that is 1 at x = 0, whatever its bumps are."""
    bumps_at_zero = 0.0
    for centre, height, bump_width in bumps:
        bumps_at_zero += height * math.exp(-0.5 * (centre / bump_width) ** 2)
    # The sum of the peak and the bumps may round to less than 1.
    margin = 1e-12 if bumps else 0.0
    return sp.Prestress(left, right, width, 1.0 - bumps_at_zero + margin, (), bumps)


def held_displacement(chance, unit):
    """Return a random pre-stress and duration under a displacement boundary.

    The levels are equal in three scenes of four. Every other scene has a bump on one side or both.
    """
    width = log_uniform(chance, 0.4, 3.0) * unit * 0.8
    left = uniform(chance, 0.1, 0.85)
    has_equal_levels = chance.random() < 0.75
    right = left if has_equal_levels else uniform(chance, -0.5, 0.85)
    bumps = ()
    if chance.random() < 0.5:
        centre = uniform(chance, 2.5, 7.0) * unit
        height = uniform(chance, -0.9, 0.1)
        bump_width = uniform(chance, 0.2, 1.5) * unit
        bumps = ((centre, height, bump_width),)
        if has_equal_levels:
            bumps += ((-centre, height, bump_width),)
    prestress = profile(left, right, width, *bumps)
    return prestress, uniform(chance, 1.5, 4.0) * math.pi * unit


def barriers(chance, unit):
    """Return a random pre-stress with a barrier on each side, and a duration."""
    width = uniform(chance, 0.2, 1.0) * unit
    level = uniform(chance, 0.15, 0.8)
    centre = uniform(chance, 1.2, 4.0) * unit
    barrier_width = uniform(chance, 0.1, 0.8) * unit
    depth = uniform(chance, 0.0, 0.8) * (1.0 if chance.random() < 0.8 else 2.0)
    centre = max(centre, width + 2.0 * barrier_width)
    height = -level - depth
    barriers = (centre, height, barrier_width), (-centre, height, barrier_width)
    prestress = profile(level, level, width, *barriers)
    return prestress, uniform(chance, 1.5, 3.0) * math.pi * unit


def held_stress(chance):
    """Return a random pre-stress and duration under a stress boundary.

    Most scenes have a negative level on the left and 0 on the right. One in three has a bump.
    """
    width = log_uniform(chance, 0.5, 4.0)
    is_negative = chance.random() < 0.7
    left = -log_uniform(chance, 0.1, 2.0) if is_negative else uniform(chance, 0.1, 0.6)
    right = 0.0 if chance.random() < 0.75 else uniform(chance, 0.0, 0.5)
    bumps = ()
    if chance.random() < 0.35:
        side = 1 if chance.random() < 0.7 else -1
        centre = side * uniform(chance, 3.5, 8.0) * width
        height = uniform(chance, -0.6, 0.1)
        bump_width = uniform(chance, 0.3, 1.5) * width
        bumps = ((centre, height, bump_width),)
    return profile(left, right, width, *bumps), uniform(chance, 4.0, 14.0) * width


@dataclass(frozen=True)
class RandomScene:
    """A random scene; ``layer`` has its release rule, boundary, gamma and pre-stress."""

    family: str
    layer: dict
    damping_ratio: float
    duration: float


def drawn(number):
    """Return the random scene with a number."""
    chance = np.random.default_rng([37, number])
    damping_ratio = float(chance.choice(RATIOS))
    release = "total" if chance.random() < 0.8 else "elastic"
    boundary = "displacement"
    if number >= FIRST_BARRIER_SCENE:
        family, gamma = "barriers", log_uniform(chance, 0.05, 1.0)
        prestress, duration = barriers(chance, 1.0 / math.sqrt(gamma))
    elif chance.random() < 0.6:
        family, gamma = "displacement boundary", log_uniform(chance, 0.05, 1.5)
        prestress, duration = held_displacement(chance, 1.0 / math.sqrt(gamma))
    else:
        family, gamma = "stress boundary", 0.0
        boundary = "stress"
        prestress, duration = held_stress(chance)
    layer = {"release": release, "boundary": boundary, "gamma": gamma, "prestress": prestress}
    return RandomScene(family, layer, damping_ratio, duration)


def simulated_numbers(scene, dx, **method):
    """Simulate a random scene with a spacing and a method, and return its measured numbers."""
    beta = scene.damping_ratio * dx
    full_scene = sp.Scene(duration=scene.duration, dx=dx, beta=beta, **scene.layer, **method)
    return measured_row(sp.simulate(full_scene), MEASURE_SETTINGS)


def lattice_numbers(scene, dx):
    """Return the measured numbers of a scene on the lattice that an accuracy is promised for."""
    ratios = scene.damping_ratio, scene.layer["gamma"] * dx**2
    step = min(1.0, choose_step("localised", 8, *ratios))
    return simulated_numbers(scene, dx, max_step=step, order=8)


def judge(number, accuracy, max_steps):
    """Return the row of one scene: how many numbers of each kind it has.

    The row has no numbers if the scene takes too many steps. The cost is the work at its spacing,
    divided by the work at the largest spacing that keeps all covered numbers.
    """
    scene = drawn(number)
    dx = sp.settings_for(accuracy, damping_ratio=scene.damping_ratio, **scene.layer)["dx"]
    result = {"scene": number, "family": scene.family}
    if scene.duration / dx > max_steps:
        return result
    spacings = [factor * dx for factor in SPACING_FACTORS]
    largest_spacing = scene.layer["prestress"].width
    rows = [lattice_numbers(scene, spacing) for spacing in spacings if spacing <= largest_spacing]
    tables = [pd.DataFrame([row]) for row in rows]
    study = grid_tables(tables[:3], SPACING_FACTORS[1:3], PARAMETERS)
    study = judge_promises(study, tables[0], accuracy, MEASURE_SETTINGS["fraction"])
    promised = study[study["kept"] != ""].set_index("quantity")
    exact_row = simulated_numbers(scene, min(0.01, scene.duration / 2000.0), scheme="continuum")
    exact = pd.Series({name: exact_row.get(name, math.nan) for name in promised.index}, dtype=float)
    # One row for each spacing, and one column for each promised number.
    errors = (pd.DataFrame(rows)[promised.index] / exact - 1.0).abs()
    is_right, is_kept = errors.iloc[0] <= accuracy, promised["kept"] == "true"
    cases = [exact.isna(), is_kept & is_right, is_kept, is_right]
    kinds = np.select(cases, ["unknown", "kept", "wrong", "missed"], "missed_rightly").tolist()
    result |= {kind: kinds.count(kind) for kind in KINDS}
    wrong = errors.iloc[0][~is_right].items()
    result["not_kept"] = "".join(f" {name} {error:.1e}" for name, error in wrong) or None
    if result["kept"] and not result["missed"] + result["missed_rightly"]:
        updates = [row["block_updates"] for row in rows]
        keeps_all = (errors.loc[:, is_kept & exact.notna()] <= accuracy).all(axis=1)
        # The spacing before the first one that does not keep all numbers is the cheapest.
        cheapest = int(np.argmin(np.append(keeps_all, False))) - 1
        result["cost"] = updates[0] / updates[cheapest]
    return result


def median(costs):
    """Return the median cost with its range, "-" if there are no costs."""
    if not len(costs):
        return "-"
    return f"{costs.median():.0f} ({costs.min():.0f} to {costs.max():.0f})"


def main(accuracy, first, count, max_steps):
    """Print rows of the table of config/README.md, numbers not kept, and scenes left out."""
    judged_scenes = [judge(number, accuracy, max_steps) for number in range(first, first + count)]
    rows = pd.DataFrame(judged_scenes, columns=COLUMNS)
    for family, group in rows.groupby("family", sort=False):
        simulated, with_cost = group.dropna(subset="kept"), group.dropna(subset="cost")
        with_pulse = with_cost[with_cost["kept"] >= MIN_KEPT_NUMBERS]
        sums = simulated[KINDS].sum().astype(int)
        cells = [family, f"{accuracy:g}", len(simulated), len(group) - len(simulated)]
        cells += [*sums, median(with_cost["cost"]), median(with_pulse["cost"])]
        print("|", " | ".join(map(str, cells)), "|")
    for row in rows.dropna(subset="not_kept").itertuples():
        print(f"not within {accuracy:g} in scene {row.scene}:{row.not_kept}")
    print("too long:", *rows.loc[rows["kept"].isna(), "scene"])


if __name__ == "__main__":
    main(float(sys.argv[1]), *map(int, sys.argv[2:]))
