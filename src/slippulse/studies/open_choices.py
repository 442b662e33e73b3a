"""Exact transitions at every admissible combination of what the paper leaves open, over the grids of figure 5."""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from ..configuration.expand import expand
from ..model.prestress import Prestress
from ..model.roots import roots_between
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import Fronts, slip_velocity
from ..theory.front_speeds import front_speed
from ..theory.pulse import paper_transition_displacement

NEEDS = {
    "lists": ["manuscript/open_choices.yaml"],
    "sweeps": ["scaling_displacement", "scaling_stress"],
}

# The first stick, over pi/sqrt(gamma), lies between these; beyond this number of widths a Gaussian is 0 to rounding;
# the error of a time.
STICK, FAR, TIME = np.array([0.3, 1.7]), 12.0, 1e-12
# Nodes of the time that a front takes across a tent.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Of each run of figure 5 boundary, release, damping_ratio, nucleation ("Gaussian", or a tent, whose tail ends),
    fraction (of the path that counts as arrest, under a stress boundary), left, width, gamma, and exact transition_time
    and transition_length and the same of the paper.
    """
    sweeps = (expand(settings["sweeps"][name])[0] for name in NEEDS["sweeps"])
    springs, cracks = (pd.DataFrame([scene.attributes() for scene in scenes]) for scenes in sweeps)
    springs, cracks = springs.query("left > 0"), cracks.query("left < 0")
    choices = tables["open_choices"].groupby("choice")
    fractions = [each for each in choices.get_group("fraction")["value"] if isinstance(each, float)]
    parts = []
    for ratio, release in choices.get_group("damping_ratio")[["value", "release"]].values:
        rows = displacement(springs, ratio, release), stress(cracks, ratio, release, fractions)
        parts += [pd.DataFrame(each).assign(damping_ratio=ratio, release=release) for each in rows]
    return pd.concat(parts, ignore_index=True)


def displacement(grid: pd.DataFrame, ratio: float, release: str) -> Iterator[dict]:
    """The first stick of symmetric scenes, at x = 0, by one pair of fronts for every gamma."""
    for (left, width), rows in grid.groupby(["left", "width"]):
        gammas, speed = rows["gamma"].to_numpy(), float(front_speed(left, ratio, release))
        first, last = STICK[:, None] * np.pi / np.sqrt(gammas)
        # The past of (0, t) begins at x + T(x) = t, so x < t.
        reach = max(float(last.max()), 2.0 * FAR * width)
        fronts = Fronts(Prestress(left, left, width), ratio, release, reach, gammas.max())

        def velocity(
            time: np.ndarray, which=slice(None), fronts=fronts, gammas=gammas
        ) -> np.ndarray:
            return slip_velocity(fronts, gammas[which], 0.0, time)

        times = roots_between(velocity, first, last, velocity(first), velocity(last), xtol=TIME)
        for gamma, time in zip(gammas.tolist(), times.tolist(), strict=True):
            # How far the right front is then; uniform beyond the Gaussian.
            late = time - float(fronts.arrival(FAR * width))
            reached = FAR * width + speed * late if late > 0.0 else fronts.reached(time, 1.0)
            estimate = paper_transition_displacement(left, gamma)
            yield {
                "boundary": "displacement", "nucleation": "Gaussian", "left": left, "width": width, "gamma": gamma,
                "transition_time": time, "transition_length": 2.0 * reached,
                "paper_transition_time": estimate[0], "paper_transition_length": estimate[1],
            }  # fmt: skip


def stress(
    grid: pd.DataFrame, ratio: float, release: str, fractions: list[float]
) -> Iterator[dict]:
    """When fractions of |x_minus| are covered, and when all of it is where the tail ends. Without leaf springs nothing
    but W is a length: every number of a level is proportional to it.
    """
    # A tent of half-width 1 on both sides of x = 0: the last characteristic enters at its end.
    crossing = float(WEIGHTS @ (1.0 / front_speed(0.5 + 0.5 * NODES, ratio, release))) / 2.0
    for left, rows in grid.groupby("left"):
        crack = ArrestingCrack(Prestress(left, 0.0), ratio, release)
        way = -crack.balance_position
        found = [
            ("Gaussian", f, crack.time_at_fraction(f), crack.length_at_fraction(f), way)
            for f in fractions
        ]
        way = 1.0 + (1.0 + 0.5 * left) / -left
        found.append(("tent", 1.0, way + 1.0 + crossing, 2.0 * way + 2.0, way))
        for width in rows["width"]:
            for nucleation, fraction, time, length, way in found:
                yield {
                    "boundary": "stress", "nucleation": nucleation, "fraction": fraction, "left": left, "width": width,
                    "transition_time": time * width, "transition_length": length * width,
                    "paper_transition_time": way * width, "paper_transition_length": 2.0 * way * width,
                }  # fmt: skip
