"""Errors of random scenes at a promised accuracy, relative to the exact solution, and their cost.

python tests/benchmark/promises.py ACCURACY FIRST COUNT MAX_STEPS prints rows of the table in
config/README.md. Scenes from number 1000 on have a barrier of negative pre-stress on both sides.
"""

import math
import sys

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
between = lambda chance, low, high: float(np.exp(chance.uniform(math.log(low), math.log(high))))


def profile(left, right, width, *bumps):
    """Return a pre-stress that is 1 at x = 0, whatever its bumps are."""
    others = sum(a * math.exp(-0.5 * (c / w) ** 2) for c, a, w in bumps)
    return sp.Prestress(left, right, width, 1.0 - others + (1e-12 if bumps else 0.0), (), bumps)


def held_displacement(chance, unit):
    """Return a random pre-stress and duration under a displacement boundary.

    The levels are equal in three scenes of four. Every other scene has a bump on one side or both.
    """
    width = between(chance, 0.4, 3.0) * unit * 0.8
    left, equal = float(chance.uniform(0.1, 0.85)), chance.random() < 0.75
    right = left if equal else float(chance.uniform(-0.5, 0.85))
    bumps = ()
    if chance.random() < 0.5:
        centre, height = float(chance.uniform(2.5, 7.0)) * unit, float(chance.uniform(-0.9, 0.1))
        bump = height, float(chance.uniform(0.2, 1.5)) * unit
        bumps = ((centre, *bump), (-centre, *bump)) if equal else ((centre, *bump),)
    return profile(left, right, width, *bumps), float(chance.uniform(1.5, 4.0)) * math.pi * unit


def barriers(chance, unit):
    """Return a random pre-stress with a barrier on each side, and a duration."""
    width, level = float(chance.uniform(0.2, 1.0)) * unit, float(chance.uniform(0.15, 0.8))
    centre, wide = float(chance.uniform(1.2, 4.0)) * unit, float(chance.uniform(0.1, 0.8)) * unit
    depth = float(chance.uniform(0.0, 0.8)) * (1.0 if chance.random() < 0.8 else 2.0)
    centre = max(centre, width + 2.0 * wide)
    bump = -level - depth, wide
    layer = profile(level, level, width, (centre, *bump), (-centre, *bump))
    return layer, float(chance.uniform(1.5, 3.0)) * math.pi * unit


def held_stress(chance):
    """Return a random pre-stress and duration under a stress boundary.

    Most scenes have a negative level on the left and 0 on the right. One in three has a bump.
    """
    width, negative = between(chance, 0.5, 4.0), chance.random() < 0.7
    left = -between(chance, 0.1, 2.0) if negative else float(chance.uniform(0.1, 0.6))
    right = 0.0 if chance.random() < 0.75 else float(chance.uniform(0.0, 0.5))
    bumps = ()
    if chance.random() < 0.35:
        side = 1 if chance.random() < 0.7 else -1
        centre, height = side * float(chance.uniform(3.5, 8.0)) * width, chance.uniform(-0.6, 0.1)
        bumps = ((centre, float(height), float(chance.uniform(0.3, 1.5)) * width),)
    return profile(left, right, width, *bumps), float(chance.uniform(4.0, 14.0)) * width


def drawn(number):
    """Return family, layer, damping ratio and duration of a random scene."""
    chance = np.random.default_rng([37, number])
    ratio = float(chance.choice(RATIOS))
    layer = {"release": "total" if chance.random() < 0.8 else "elastic", "boundary": "displacement"}
    if number >= FIRST_BARRIER_SCENE:
        family, layer["gamma"] = "barriers", between(chance, 0.05, 1.0)
        layer["prestress"], duration = barriers(chance, 1.0 / math.sqrt(layer["gamma"]))
    elif chance.random() < 0.6:
        family, layer["gamma"] = "displacement boundary", between(chance, 0.05, 1.5)
        layer["prestress"], duration = held_displacement(chance, 1.0 / math.sqrt(layer["gamma"]))
    else:
        family = "stress boundary"
        layer |= {"boundary": "stress", "gamma": 0.0}
        layer["prestress"], duration = held_stress(chance)
    return family, layer, ratio, duration


def numbers(layer, duration, dx, ratio, **scheme):
    """Simulate a scene, and return its measured numbers."""
    scene = sp.Scene(duration=duration, dx=dx, beta=ratio * dx, **layer, **scheme)
    return measured_row(sp.simulate(scene), MEASURE_SETTINGS)


def judge(number, accuracy, max_steps):
    """Return the row of one scene: how many numbers of each kind it has.

    The row has no numbers if the scene takes too many steps. The cost is the work at its spacing,
    divided by the work at the largest spacing that keeps all covered numbers.
    """
    family, layer, ratio, duration = drawn(number)
    dx = sp.settings_for(accuracy, damping_ratio=ratio, **layer)["dx"]
    result = {"scene": number, "family": family}
    if duration / dx > max_steps:
        return result
    rows = []
    for spacing in (
        factor * dx for factor in SPACING_FACTORS if factor * dx <= layer["prestress"].width
    ):
        step = min(1.0, choose_step("localised", 8, ratio, layer["gamma"] * spacing**2))
        rows.append(numbers(layer, duration, spacing, ratio, max_step=step, order=8))
    tables = [pd.DataFrame([row]) for row in rows]
    study = grid_tables(tables[:3], SPACING_FACTORS[1:3], PARAMETERS)
    study = judge_promises(study, tables[0], accuracy, MEASURE_SETTINGS["fraction"])
    truth = numbers(layer, duration, min(0.01, duration / 2000.0), ratio, scheme="continuum")
    promised = study[study["kept"] != ""].set_index("quantity")
    exact = pd.Series({name: truth.get(name, math.nan) for name in promised.index}, dtype=float)
    errors = (pd.DataFrame(rows)[promised.index] / exact - 1.0).abs()
    right, kept = errors.iloc[0] <= accuracy, promised["kept"] == "true"
    cases = [exact.isna(), kept & right, kept, right]
    kinds = np.select(cases, ["unknown", "kept", "wrong", "missed"], "missed_rightly").tolist()
    result |= {kind: kinds.count(kind) for kind in KINDS}
    wrong = errors.iloc[0][~right].items()
    result["not_kept"] = "".join(f" {name} {error:.1e}" for name, error in wrong) or None
    if result["kept"] and not result["missed"] + result["missed_rightly"]:
        updates = [row["block_updates"] for row in rows]
        keeping = (errors.loc[:, kept & exact.notna()] <= accuracy).all(axis=1)
        cheapest = int(np.argmin(np.append(keeping, False))) - 1
        result["cost"] = updates[0] / updates[cheapest]
    return result


def median(costs):
    """Return the median cost with its range, "-" if there are no costs."""
    if not len(costs):
        return "-"
    return f"{costs.median():.0f} ({costs.min():.0f} to {costs.max():.0f})"


def main(accuracy, first, count, max_steps):
    """Print rows of the table of config/README.md, numbers not kept, and scenes left out."""
    judged_scenes = (judge(number, accuracy, max_steps) for number in range(first, first + count))
    rows = pd.DataFrame(judged_scenes, columns=COLUMNS)
    for family, group in rows.groupby("family", sort=False):
        done, costly = group.dropna(subset="kept"), group.dropna(subset="cost")
        costs = [
            median(part["cost"]) for part in (costly, costly[costly["kept"] >= MIN_KEPT_NUMBERS])
        ]
        sums = done[KINDS].sum().astype(int)
        cells = [family, f"{accuracy:g}", len(done), len(group) - len(done), *sums, *costs]
        print("|", " | ".join(map(str, cells)), "|")
    for row in rows.dropna(subset="not_kept").itertuples():
        print(f"not within {accuracy:g} in scene {row.scene}:{row.not_kept}")
    print("too long:", *rows.loc[rows["kept"].isna(), "scene"])


if __name__ == "__main__":
    main(float(sys.argv[1]), *map(int, sys.argv[2:]))
