"""Exact transitions at every admissible combination of what the paper leaves open, over the grids of figure 5."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from ..configuration.expand import expand
from ..model.prestress import Prestress
from ..theory.arrest import ArrestingCrack
from ..theory.exact_transition import Fronts, slip_velocity
from ..theory.front_law import front_speed
from ..theory.pulse import paper_transition_displacement

NEEDS = {
    "lists": ["manuscript/open_choices.yaml"],
    "sweeps": ["scaling_displacement", "scaling_stress"],
}

# The first stick, over pi/sqrt(gamma), lies between these; beyond this number of widths a Gaussian is 0 to rounding.
STICK, FAR = (0.3, 1.7), 12.0
# Nodes of the time that a front takes across a tent.
NODES, WEIGHTS = np.polynomial.legendre.leggauss(24)


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """T_trans and L_trans of each run of figure 5, with the paper's estimates, by the exact theory.

    Returns
    -------
    DataFrame of boundary, release, damping_ratio, nucleation ("Gaussian", or a tent, whose tail ends), fraction (of the
    path that counts as arrest, under a stress boundary), left, width, gamma, transition_time and transition_length, and
    paper_transition_time and paper_transition_length
    """
    choices = tables["open_choices"]
    scenes = {name: expand(sweep)[0] for name, sweep in settings["sweeps"].items()}
    grids = {
        name: pd.DataFrame([_scene(scene) for scene in each], columns=["left", "width", "gamma"])
        for name, each in scenes.items()
    }
    fractions = choices.loc[choices["choice"] == "fraction", "value"]
    shares = [float(share) for share in fractions if isinstance(share, float)]
    parts = []
    for _, row in choices[choices["choice"] == "damping_ratio"].iterrows():
        friction = float(row["value"]), str(row["release"])
        named = {"damping_ratio": friction[0], "release": friction[1]}
        parts += [
            pd.DataFrame(rows).assign(**named)
            for rows in (
                displacement(grids["scaling_displacement"].query("left > 0"), *friction),
                stress(grids["scaling_stress"].query("left < 0"), *friction, shares),
            )
        ]
    return pd.concat(parts, ignore_index=True)


def _scene(scene) -> dict[str, float]:
    return {"left": scene.prestress.left, "width": scene.prestress.width, "gamma": scene.gamma}


def displacement(grid: pd.DataFrame, ratio: float, release: str) -> Iterator[dict]:
    """The first stick of symmetric scenes, by one pair of fronts for every gamma."""
    for (left, width), rows in grid.groupby(["left", "width"]):
        period, speed = np.pi / np.sqrt(rows["gamma"]), float(front_speed(left, ratio, release))
        # The past of (0, t) begins at x + T(x) = t, so x < t.
        reach = max(STICK[1] * period.max(), 2.0 * FAR * width)
        fronts = Fronts(Prestress(left, left, width), ratio, release, reach, rows["gamma"].max())
        for gamma, half in zip(rows["gamma"], period, strict=True):
            time = first_stick(fronts, gamma, half)
            estimate = paper_transition_displacement(left, gamma)
            yield {
                "boundary": "displacement", "nucleation": "Gaussian", "left": left, "width": width, "gamma": gamma,
                "transition_time": time, "transition_length": 2.0 * _reached(fronts, time, FAR * width, speed),
                "paper_transition_time": estimate[0], "paper_transition_length": estimate[1],
            }  # fmt: skip


def first_stick(fronts: Fronts, gamma: float, half: float) -> float:
    """When the nucleation point comes to rest; ``half``: half a period of the leaf springs."""
    return brentq(
        lambda t: slip_velocity(fronts, gamma, 0.0, t), STICK[0] * half, STICK[1] * half, rtol=1e-10
    )


def _reached(fronts: Fronts, time: float, far: float, speed: float) -> float:
    """How far the right front is at a time; uniform beyond ``far``."""
    late = time - float(fronts.arrival(far))
    return far + speed * late if late > 0.0 else fronts.reached(time, 1.0)


def stress(grid: pd.DataFrame, ratio: float, release: str, fractions: list[float]) -> Iterator[dict]:
    """When fractions of |x_minus| are covered, and when all of it is where the tail ends.

    Without leaf springs nothing but W is a length: every number of a level is proportional to it.
    """
    # A tent of half-width 1 on both sides of x = 0: the last characteristic enters at its end.
    crossing = float(WEIGHTS @ (1.0 / front_speed(0.5 + 0.5 * NODES, ratio, release))) / 2.0
    for left, rows in grid.groupby("left"):
        crack = ArrestingCrack(Prestress(left, 0.0), ratio, release)
        found = {("Gaussian", f): (crack.share_time(f), crack.share_length(f)) for f in fractions}
        distance = {"Gaussian": -crack.balance_position, "tent": 1.0 + (1.0 + 0.5 * left) / -left}
        found["tent", 1.0] = distance["tent"] + 1.0 + crossing, 2.0 * distance["tent"] + 2.0
        for width in rows["width"]:
            for (nucleation, fraction), (time, length) in found.items():
                way = distance[nucleation] * width
                yield {
                    "boundary": "stress", "nucleation": nucleation, "fraction": fraction, "left": left, "width": width,
                    "transition_time": time * width, "transition_length": length * width, "paper_transition_time": way,
                    "paper_transition_length": 2.0 * way,
                }  # fmt: skip
