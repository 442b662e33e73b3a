"""Random scenes at a promised accuracy against the exact solution, and what they cost.

python tests/benchmark/promises.py ACCURACY FIRST COUNT [MOST_STEPS] prints the rows of the table in
config/README.md. Scenes from number 1000 on have a barrier of negative pre-stress on both sides.
"""

import math
import sys
from collections import Counter

import numpy as np
import pandas as pd

import slippulse as sp
from slippulse.measurement.promise import judged
from slippulse.measurement.table import PARAMETERS
from slippulse.measurement.uncertainty import grid_tables
from slippulse.model.stability import chosen_step
from slippulse.predict.comparison import measured_row
from slippulse.predict.one_run import SETTINGS

FACTORS = (1.0, 2.0, 4.0, 8.0)
BARRIERS = 1000
RATIOS = (0.0, 0.02, 0.05, 0.1, 0.3, 1.0)


def profile(left, right, width, *bumps):
    """Pre-stress that is 1 at x = 0 in spite of bumps."""
    others = sum(a * math.exp(-0.5 * (c / w) ** 2) for c, a, w in bumps)
    peak = 1.0 - others + (1e-12 if bumps else 0.0)
    return sp.Prestress(left, right, width, peak, (), bumps)


def between(chance, low, high):
    """Random number with a uniform logarithm."""
    return float(np.exp(chance.uniform(math.log(low), math.log(high))))


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
    """A barrier of negative pre-stress on each side."""
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
    """Measured numbers of a scene."""
    scene = sp.Scene(duration=duration, dx=dx, beta=ratio * dx, **layer, **scheme)
    return measured_row(sp.simulate(scene), SETTINGS)


def judge(number, accuracy, most_steps):
    """Family of a scene, and how many numbers of each kind it has; or None beyond ``most_steps``.

    Its cost is that of its spacing over that of the largest one that keeps all covered numbers.
    """
    family, layer, ratio, duration = drawn(number)
    dx = sp.settings_for(accuracy, damping_ratio=ratio, **layer)["dx"]
    if duration / dx > most_steps:
        return family, None
    rows = []
    for spacing in (factor * dx for factor in FACTORS if factor * dx <= layer["prestress"].width):
        step = chosen_step("localised", 8, ratio, layer["gamma"] * spacing**2, enough=1.0)
        rows.append(numbers(layer, duration, spacing, ratio, max_step=step, order=8))
    tables = [pd.DataFrame([row]) for row in rows]
    study = judged(
        grid_tables(tables[:3], FACTORS[1:3], PARAMETERS), tables[0], accuracy, SETTINGS["share"]
    )
    fine = min(0.01, duration / 2000.0)
    truth = numbers(layer, duration, fine, ratio, scheme="continuum")
    counts, keeping = Counter(scenes=1), np.ones(len(rows), dtype=bool)
    for name, kept in study.loc[study["kept"] != "", ["quantity", "kept"]].itertuples(index=False):
        exact = truth.get(name, math.nan)
        errors = np.array([abs(row[name] / exact - 1.0) for row in rows])
        if not math.isfinite(exact):
            counts["unknown"] += 1
        elif kept == "true":
            counts["kept" if errors[0] <= accuracy else "wrong"] += 1
            keeping &= errors <= accuracy
        else:
            counts["missed"] += 1
    updates = [row["block_updates"] for row in rows]
    if counts["kept"] and not counts["missed"]:
        cheapest = int(np.argmin(np.append(keeping, False))) - 1
        counts["cost"] = max(updates) / updates[cheapest]
    return family, counts


def main(accuracy, first, count, most_steps):
    """Print one row a family."""
    results = [judge(number, accuracy, most_steps) for number in range(first, first + count)]
    for family in sorted({family for family, _ in results}):
        counts = [found for name, found in results if name == family]
        done = [found for found in counts if found is not None]
        costs = [found["cost"] for found in done if found["cost"]]
        cost = f"{np.median(costs):.0f} ({min(costs):.0f} to {max(costs):.0f})" if costs else "-"
        sums = [sum(one[name] for one in done) for name in ("kept", "wrong", "missed", "unknown")]
        cells = [family, accuracy, len(done), len(counts) - len(done), *sums, cost]
        print("|", " | ".join(map(str, cells)), "|")


if __name__ == "__main__":
    given = sys.argv[1:]
    main(float(given[0]), int(given[1]), int(given[2]), float(given[3]) if given[3:] else 3500.0)
