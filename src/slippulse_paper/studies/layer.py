"""The layer in the plane, beside the paper's equation in one dimension, under slip weakening."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.solver.layer import LayerScene, simulate_layer
from slippulse.theory.closed_pulse import (
    paper_pulse,
    paper_transition_displacement,
    paper_transition_stress,
)
from slippulse.theory.law_pulses import undamped_weakening_slip, weakening_pulse

NEEDS = {"settings": ()}

# gamma of lambda = G, for which the paper means its formulas; smaller ones give pulses of many H.
GAMMA = 2.0 / 3.0
GAMMAS = (GAMMA, 0.3, 0.12, 0.06)
LEVELS = (0.5, 0.65, 0.8, 0.95)
# Fracture energy d_c/2 over tau_0^2/(2 gamma), the most that a length of the layer releases.
TOUGHNESS = 5.0 / 12.0
# Half of the length without friction, in half of which speeds are fitted, and the duration, at
# GAMMA; they are longer at smaller gamma, as the paper's pulses are.
NUCLEATION, DURATION = 2.0, 30.0
# Three grids show what converges; one case has a finer one.
CELLS, FINE = (10, 20, 40), (20, 40, 80)
# Fractions of the path of the front at which a pulse is measured: the last two say if it settles.
STATIONS = (0.3, 0.6, 0.85)
# The paper's damping.
BETA = 1e-3
# Pre-stress and weakening of the pulse whose top is free to rise, and of a crack under held stress.
FREE, CRACK = (0.5, 0.225), (0.8, 0.8)
# A level that stops the left front under held stress, the width of the Gaussian at nucleation, and
# weakenings.
BARRIER, WIDTH = -0.75, 5.0
WEAKENINGS = (0.05, 0.2, 0.8)
# Coefficients of friction of a strength that follows the normal stress.
COUPLINGS = (0.3, 0.6)
# The drawn pulse, at twice the length of nucleation after this time, on every second cell.
SNAPSHOT, EVERY = 12.0, 2


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Rows of a run at its stations by part, beside one dimension (pulse), and the part field.

    Parts: pulse (held displacement), free (its top free to rise), coupled (strength by normal
    stress), fine (one pulse on a finer grid), crack and barrier (held stress).
    """
    rows = []
    for gamma, tau0 in product(GAMMAS, LEVELS):
        scene = uniform("displacement", gamma, tau0, TOUGHNESS * tau0**2 / gamma)
        in_one_dimension = one_dimension(scene)
        rows += [row | in_one_dimension for row in on_grids("pulse", scene, CELLS)]
    rows += on_grids("free", replace(uniform("displacement", GAMMA, *FREE), top="free"), CELLS)
    crack, barrier = uniform("stress", GAMMA, *CRACK), Prestress(BARRIER, 0.0, WIDTH)
    rows += on_grids("crack", crack, CELLS)
    main = uniform("displacement", GAMMA, 0.8, TOUGHNESS * 0.8**2 / GAMMA)
    rows += on_grids("fine", main, FINE)
    for coupling in COUPLINGS:
        rows += on_grids("coupled", replace(main, coupling=coupling), FINE[:2], (1, -1))
    crack = replace(crack, prestress=barrier, duration=1.8 * DURATION)
    balance = {"balance_distance": paper_transition_stress(barrier)[0]}
    for weakening in WEAKENINGS:
        stopped = on_grids("barrier", replace(crack, weakening=weakening), CELLS, (1, -1))
        rows += [row | balance for row in stopped]
    return pd.concat([pd.DataFrame(rows), field(replace(main, duration=SNAPSHOT))])


def uniform(boundary: str, gamma: float, tau0: float, weakening: float) -> LayerScene:
    """Scene in uniform pre-stress, which a length without friction nucleates."""
    stretch = math.sqrt(GAMMA / gamma)
    duration, nucleation = DURATION * stretch, NUCLEATION * stretch
    prestress = Prestress(tau0, tau0, peak=tau0)
    return LayerScene(boundary, gamma, prestress, weakening, duration, nucleation=nucleation)


def on_grids(
    part: str, scene: LayerScene, grids: Sequence[int], sides: Sequence[int] = (1,)
) -> list[dict[str, Any]]:
    """Rows of one scene, for each grid, side and station, of what passes there and is left."""
    rows = []
    for cells in grids:
        run = simulate_layer(replace(scene, cells=cells))
        known: dict[str, Any] = {"part": part, "gamma": scene.gamma, "tau0": scene.prestress.right}
        known |= {"weakening": scene.weakening, "coupling": scene.coupling, "cells": cells}
        # The first stick is that in the length without friction, infinite without any.
        sticks = run.stick_time[np.abs(run.x) <= scene.nucleation]
        known["first_stick"] = float(sticks[np.isfinite(sticks)].min(initial=math.inf))
        known["energy_residual"] = run.energy_residual
        half = 0.5 * scene.nucleation
        for side in sides:
            end = float((side * run.x[np.isfinite(run.release_time)]).max())
            for station in STATIONS:
                near = np.abs(run.x - side * station * end) <= half
                speed = 1.0 / abs(np.polyfit(run.x[near], run.release_time[near], 1)[0])
                width = speed * float((run.stick_time - run.release_time)[near].mean())
                row = {"side": side, "end": side * end, "station": station, "speed": speed}
                row |= {"pulse_width": width, "pulse_slip": float(run.slip[near].mean())}
                rows.append(known | row)
    return rows


def one_dimension(scene: LayerScene) -> dict[str, float]:
    """Numbers of the paper's equation at the parameters of a scene, and times of a strip."""
    tau0, gamma = scene.prestress.right, scene.gamma
    weakening = scene.weakening
    paper, damped = paper_pulse(tau0, gamma), weakening_pulse(tau0, gamma, BETA, weakening)
    return {
        "paper_speed": paper.speed,
        "paper_pulse_width": paper.width,
        "paper_pulse_slip": paper.slip,
        "paper_first_stick": paper_transition_displacement(tau0, gamma)[0],
        # A strip that slides as one sticks when a shear wave has gone to the top and back.
        "strip_first_stick": 2.0 / math.sqrt(0.5 * gamma),
        "damped_speed": damped.speed,
        "damped_pulse_width": damped.width,
        "damped_pulse_slip": damped.slip,
        "balance_pulse_slip": undamped_weakening_slip(tau0, gamma, weakening),
    }


def field(scene: LayerScene) -> pd.DataFrame:
    """Horizontal velocity over the layer at the end of a scene, where anything has moved."""
    run = simulate_layer(scene)
    ahead = run.x <= scene.duration + 2.0 * scene.nucleation
    columns = np.flatnonzero(ahead)[::EVERY]
    rows = np.arange(0, scene.cells + 1, EVERY)
    y, x = np.meshgrid(rows / scene.cells, run.x[columns], indexing="ij")
    velocity = run.velocity[np.ix_(rows, columns)]
    shape = {"x": x.ravel(), "y": y.ravel(), "velocity": velocity.ravel()}
    numbers = {"gamma": scene.gamma, "tau0": scene.prestress.right, "weakening": scene.weakening}
    return pd.DataFrame(shape).assign(part="field", time=scene.duration, **numbers)
