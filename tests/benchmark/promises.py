"""Random scenes at a promised accuracy against the exact solution, and what they cost.

python tests/benchmark/promises.py ACCURACY FIRST COUNT MOST_STEPS prints rows of the table in
config/README.md. Scenes from number 1000 on have a barrier of negative pre-stress on both sides.
"""

import math
import sys

import numpy as np
import pandas as pd

import slippulse as sp
from slippulse.measurement.promise import judged
from slippulse.measurement.table import PARAMETERS
from slippulse.measurement.uncertainty import grid_tables
from slippulse.model.stability import chosen_step
from slippulse.predict.comparison import measured_row
from slippulse.predict.one_run import SETTINGS

# The first three are the grid study, the others look for the cheapest spacing that is enough.
FACTORS = (1.0, 2.0, 4.0, 8.0, 16.0, 32.0)
# Scenes with this number of covered numbers or more have a pulse or a transition among them.
MANY = 5
KINDS = ["kept", "wrong", "missed", "missed_rightly", "unknown"]
COLUMNS = ["scene", "family", *KINDS, "cost", "not_kept"]
BARRIERS = 1000
RATIOS = (0.0, 0.02, 0.05, 0.1, 0.3, 1.0)
between = lambda chance, low, high: float(np.exp(chance.uniform(math.log(low), math.log(high))))


def profile(left, right, width, *bumps):
    """Pre-stress that is 1 at x = 0 in spite of bumps."""
    others = sum(a * math.exp(-0.5 * (c / w) ** 2) for c, a, w in bumps)
    return sp.Prestress(left, right, width, 1.0 - others + (1e-12 if bumps else 0.0), (), bumps)


def held_displacement(chance, unit):
    """Levels on both sides, equal in three of four; in one of two a bump, or one on each side."""
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
    width, level = float(chance.uniform(0.2, 1.0)) * unit, float(chance.uniform(0.15, 0.8))
    centre, wide = float(chance.uniform(1.2, 4.0)) * unit, float(chance.uniform(0.1, 0.8)) * unit
    depth = float(chance.uniform(0.0, 0.8)) * (1.0 if chance.random() < 0.8 else 2.0)
    centre = max(centre, width + 2.0 * wide)
    bump = -level - depth, wide
    layer = profile(level, level, width, (centre, *bump), (-centre, *bump))
    return layer, float(chance.uniform(1.5, 3.0)) * math.pi * unit


def held_stress(chance):
    """A negative level on the left in most, 0 on the right in most; in one of three a bump."""
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
    """Family, layer and duration of a random scene."""
    chance = np.random.default_rng([37, number])
    ratio = float(chance.choice(RATIOS))
    release = "total" if chance.random() < 0.8 else "elastic"
    held = number >= BARRIERS or chance.random() < 0.6
    family, gamma = "stress boundary", 0.0
    if held:
        gamma = between(chance, 0.05, 1.0 if number >= BARRIERS else 1.5)
        unit = 1.0 / math.sqrt(gamma)
        shape = (barriers if number >= BARRIERS else held_displacement)(chance, unit)
        family = "barriers" if number >= BARRIERS else "displacement boundary"
    else:
        shape = held_stress(chance)
    boundary = "displacement" if held else "stress"
    layer = {"boundary": boundary, "prestress": shape[0], "gamma": gamma, "release": release}
    return family, layer, ratio, shape[1]


def numbers(layer, duration, dx, ratio, **scheme):
    scene = sp.Scene(duration=duration, dx=dx, beta=ratio * dx, **layer, **scheme)
    return measured_row(sp.simulate(scene), SETTINGS)


def judge(number, accuracy, most_steps):
    """Row of one scene: how many numbers of each kind it has; none if it takes too many steps.

    Its cost is that of its spacing over that of the largest one that keeps all covered numbers.
    """
    family, layer, ratio, duration = drawn(number)
    dx = sp.settings_for(accuracy, damping_ratio=ratio, **layer)["dx"]
    result = {"scene": number, "family": family}
    if duration / dx > most_steps:
        return result
    rows = []
    for spacing in (factor * dx for factor in FACTORS if factor * dx <= layer["prestress"].width):
        step = min(1.0, chosen_step("localised", 8, ratio, layer["gamma"] * spacing**2))
        rows.append(numbers(layer, duration, spacing, ratio, max_step=step, order=8))
    tables = [pd.DataFrame([row]) for row in rows]
    study = grid_tables(tables[:3], FACTORS[1:3], PARAMETERS)
    study = judged(study, tables[0], accuracy, SETTINGS["share"])
    truth = numbers(layer, duration, min(0.01, duration / 2000.0), ratio, scheme="continuum")
    result |= dict.fromkeys(KINDS, 0)
    keeping = np.ones(len(rows), dtype=bool)
    for name, kept in study.loc[study["kept"] != "", ["quantity", "kept"]].itertuples(index=False):
        exact = truth.get(name, math.nan)
        errors = np.array([abs(row[name] / exact - 1.0) for row in rows])
        right = errors[0] <= accuracy
        if not math.isfinite(exact):
            kind = "unknown"
        elif kept == "true":
            kind = "kept" if right else "wrong"
            keeping &= errors <= accuracy
        else:
            kind = "missed" if right else "missed_rightly"
        result[kind] += 1
        if not right:
            result["not_kept"] = f"{result.get('not_kept', '')} {name} {errors[0]:.1e}"
    if result["kept"] and not result["missed"] + result["missed_rightly"]:
        updates = [row["block_updates"] for row in rows]
        cheapest = int(np.argmin(np.append(keeping, False))) - 1
        result["cost"] = updates[0] / updates[cheapest]
    return result


def median(costs):
    """Median cost with its range; "-" for none."""
    if not len(costs):
        return "-"
    return f"{costs.median():.0f} ({costs.min():.0f} to {costs.max():.0f})"


def main(accuracy, first, count, most_steps):
    """Print rows of the table of config/README.md, numbers not kept, and scenes left out."""
    judged_scenes = (judge(number, accuracy, most_steps) for number in range(first, first + count))
    rows = pd.DataFrame(judged_scenes, columns=COLUMNS)
    for family, group in rows.groupby("family", sort=False):
        done, costly = group.dropna(subset="kept"), group.dropna(subset="cost")
        costs = [median(part["cost"]) for part in (costly, costly[costly["kept"] >= MANY])]
        sums = done[KINDS].sum().astype(int)
        cells = [family, f"{accuracy:g}", len(done), len(group) - len(done), *sums, *costs]
        print("|", " | ".join(map(str, cells)), "|")
    for row in rows.dropna(subset="not_kept").itertuples():
        print(f"not within {accuracy:g} in scene {row.scene}:{row.not_kept}")
    print("too long:", *rows.loc[rows["kept"].isna(), "scene"])


if __name__ == "__main__":
    main(float(sys.argv[1]), *map(int, sys.argv[2:]))
