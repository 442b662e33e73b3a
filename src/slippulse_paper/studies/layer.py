"""Simulate the layer in two dimensions with slip weakening, and compare it with the paper.

Fracture energies d_c/2 are given as fractions of G_0 = tau_0^2/(2 gamma), the energy that a length
of the layer releases between the pre-stress and the kinetic friction.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from slippulse.model.prestress import Prestress
from slippulse.solver.layer import LayerRun, LayerScene, simulate_layer
from slippulse.theory.closed_pulse import paper_pulse, paper_transition_stress
from slippulse.theory.law_pulses import undamped_weakening_slip, weakening_pulse

NEEDS = {"settings": ()}

# gamma for lambda = G, which the paper has in mind; at smaller gamma pulses are many H wide.
GAMMA = 2.0 / 3.0
GAMMAS = (GAMMA, 0.3, 0.12, 0.06)
# Fracture energies divided by G_0 at LEVEL, and other levels at one fracture energy.
FRACTURE_ENERGIES = (0.05, 0.09, 0.21, 0.42, 0.7, 0.9)
LEVEL, OTHER_LEVELS, OTHER_LEVELS_ENERGY = 0.8, (0.5, 0.65, 0.95), 0.42
# Half-length of the region without friction, and the duration, at GAMMA. At other gamma all lengths
# and times are multiplied by sqrt(GAMMA/gamma), like those of the paper's pulses.
NUCLEATION_HALF_LENGTH, DURATION = 2.0, 48.0
# Positions at which a pulse is measured at GAMMA. Each measurement averages over a window around
# the position; comparing the last two positions shows whether the pulse is steady.
STATION_POSITIONS = (6.0, 13.0, 16.0)
# The same for other parts, as fractions of the path of the front.
FRACTIONS_OF_PATH = (0.3, 0.6, 0.85)
# Cells over the height. The run on the first grid determines how long the other runs must be.
CELLS, FINE_CELLS = (10, 20, 40), (20, 40, 80)
# The finer grids are used below this fracture energy and above this gamma: small fracture energies
# need them, but at small gamma they would take too long.
FINE_GRID_MAX_ENERGY, FINE_GRID_MIN_GAMMA = 0.3, 0.2
# Margins, relative and in H, for a trailing edge that arrives later on a finer grid.
TRAIL_MARGINS = 0.03, 1.0
# The paper's damping.
BETA = 1e-3
# Pre-stress and weakening of a pulse whose top may rise, and of a crack under held stress.
FREE_TOP_CASE, CRACK_CASE, OTHER_DURATION = (0.5, 0.225), (0.8, 0.8), 30.0
# Level that stops the left front under held stress, width of the Gaussian at nucleation, and
# weakening distances.
BARRIER_LEVEL, GAUSSIAN_WIDTH = -0.75, 5.0
WEAKENINGS = (0.05, 0.2, 0.8)
# Friction coefficients of a strength that depends on the normal stress.
COUPLINGS = (0.3, 0.6)
# A pulse enters another pre-stress at STEP_POSITION, with this weakening and these levels at GAMMA.
# It is measured at positions before and beyond the step.
STEP_POSITION, STEP_WEAKENING, STEP_LEVELS = 10.0, 0.3, (0.65, 0.8)
STEP_STATIONS = (9.0, 11.0, 12.0, 13.5, 15.0, 18.0, 21.0, 24.0)
# Fracture energy of the pulse that is drawn, time of the picture, and every how many cells.
DRAWN_ENERGY, SNAPSHOT_TIME, DRAWN_EVERY_CELLS = 0.21, 12.0, 2


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the measurements of all runs by part, and the part field for the picture.

    Parts: pulse (held displacement), patch (the same until the length without friction has stuck),
    step (a pulse enters another pre-stress), free (its top free to rise), coupled (strength by
    normal stress), crack and barrier (held stress).
    """
    rows = []
    for gamma in GAMMAS:
        cases = [(LEVEL, energy) for energy in FRACTURE_ENERGIES]
        for tau0, energy in cases + [(tau0, OTHER_LEVELS_ENERGY) for tau0 in OTHER_LEVELS]:
            scene = uniform("displacement", gamma, tau0, energy * tau0**2 / gamma)
            theory = one_dimension(scene)
            grids = (
                FINE_CELLS
                if energy < FINE_GRID_MAX_ENERGY and gamma > FINE_GRID_MIN_GAMMA
                else CELLS
            )
            rows += [row | theory for row in at_places("pulse", scene, grids, STATION_POSITIONS)]
        # A strip that slides uniformly sticks when a shear wave has run to the top and back.
        strip = {"strip_first_stick": 2.0 / math.sqrt(0.5 * gamma)}
        patch = uniform("displacement", gamma, LEVEL, OTHER_LEVELS_ENERGY * LEVEL**2 / gamma)
        patch = replace(patch, duration=1.2 * strip["strip_first_stick"])
        rows += [
            row | strip for row in along_path("patch", patch, CELLS)[:: len(FRACTIONS_OF_PATH)]
        ]
    for before, level in product(STEP_LEVELS, repeat=2):
        rows += across_a_step(GAMMA, level, STEP_WEAKENING, before, CELLS[1:])
    rows += along_path(
        "free", replace(uniform("displacement", GAMMA, *FREE_TOP_CASE), top="free"), CELLS
    )
    crack, barrier = (
        uniform("stress", GAMMA, *CRACK_CASE),
        Prestress(BARRIER_LEVEL, 0.0, GAUSSIAN_WIDTH),
    )
    rows += along_path("crack", crack, CELLS)
    main = uniform("displacement", GAMMA, LEVEL, OTHER_LEVELS_ENERGY * LEVEL**2 / GAMMA)
    for coupling in COUPLINGS:
        rows += along_path("coupled", replace(main, coupling=coupling), FINE_CELLS[:2], (1, -1))
    crack = replace(crack, prestress=barrier, duration=1.8 * OTHER_DURATION)
    balance = {"balance_distance": paper_transition_stress(barrier)[0]}
    for weakening in WEAKENINGS:
        stopped = along_path("barrier", replace(crack, weakening=weakening), CELLS, (1, -1))
        rows += [row | balance for row in stopped]
    drawn = uniform("displacement", GAMMA, LEVEL, DRAWN_ENERGY * LEVEL**2 / GAMMA)
    return pd.concat([pd.DataFrame(rows), field(replace(drawn, duration=SNAPSHOT_TIME))])


def stretch(gamma: float) -> float:
    """Return the lengths and times of a scene divided by those at GAMMA."""
    return math.sqrt(GAMMA / gamma)


def uniform(boundary: str, gamma: float, tau0: float, weakening: float) -> LayerScene:
    """Return a scene in uniform pre-stress; a region without friction nucleates the rupture."""
    duration, nucleation = OTHER_DURATION * stretch(gamma), NUCLEATION_HALF_LENGTH * stretch(gamma)
    prestress = Prestress(tau0, tau0, peak=tau0)
    return LayerScene(boundary, gamma, prestress, weakening, duration, nucleation=nucleation)


def across_a_step(
    gamma: float,
    level: float,
    weakening: float,
    before: float,
    grids: Sequence[int],
    places: Sequence[float] = STEP_STATIONS,
) -> list[dict[str, Any]]:
    """Measure a pulse that forms in one pre-stress and enters another one at STEP_POSITION."""
    scene, position = (
        uniform("displacement", gamma, before, weakening),
        STEP_POSITION * stretch(gamma),
    )
    if before != level:
        steps = (position, level), (-position, level)
        scene = replace(scene, prestress=replace(scene.prestress, steps=steps))
    rows = at_places("step", scene, grids, places)
    energy = weakening * gamma / level**2
    return [row | {"before": before, "tau0": level, "fracture_energy": energy} for row in rows]


def at_places(
    part: str, scene: LayerScene, grids: Sequence[int], places: Sequence[float]
) -> list[dict[str, Any]]:
    """Measure one scene at fixed positions on each grid; a run ends soon after the last one."""
    scene = replace(scene, duration=DURATION * stretch(scene.gamma))
    positions = [place * stretch(scene.gamma) for place in places]
    rows = []
    for cells in grids:
        run = simulate_layer(replace(scene, cells=cells))
        rows += measured(part, replace(scene, cells=cells), run, 1, positions)
        if cells == grids[0]:
            scene = shortened(scene, run, positions)
    return rows


def shortened(scene: LayerScene, run: LayerRun, positions: Sequence[float]) -> LayerScene:
    """Return the scene with a duration and a trail that suffice to measure at all positions.

    The scene is returned as it is if the pulse does not pass all of them.
    """
    half = 0.5 * scene.nucleation
    near = (run.x >= min(positions) - half) & (run.x <= max(positions) + half)
    sticks = run.stick_time[near]
    if not np.isfinite(sticks).all():
        return scene
    relative, absolute = TRAIL_MARGINS
    later = absolute + relative * float(sticks.max())
    return replace(
        scene,
        duration=float(sticks.max()) + later,
        trail=max(0.0, float((sticks - run.x[near]).max())) + later,
    )


def along_path(
    part: str, scene: LayerScene, grids: Sequence[int], sides: Sequence[int] = (1,)
) -> list[dict[str, Any]]:
    """Measure one scene at fractions of the path of its front, for each grid and side."""
    rows = []
    for cells in grids:
        run = simulate_layer(replace(scene, cells=cells))
        for side in sides:
            end = float((side * run.x[np.isfinite(run.release_time)]).max())
            positions = [side * fraction * end for fraction in FRACTIONS_OF_PATH]
            rows += measured(part, replace(scene, cells=cells), run, side, positions)
    return rows


def measured(
    part: str, scene: LayerScene, run: LayerRun, side: int, positions: Sequence[float]
) -> list[dict[str, Any]]:
    """Measure the pulse that passes each position of a run, and the slip that it leaves."""
    tau0, gamma = scene.prestress.right, scene.gamma
    known: dict[str, Any] = {"part": part, "gamma": gamma, "tau0": tau0, "side": side}
    known |= {"weakening": scene.weakening, "coupling": scene.coupling, "cells": scene.cells}
    if tau0 > 0.0:
        known["fracture_energy"] = scene.weakening * gamma / tau0**2
    # Infinite if the middle of the region without friction never sticks.
    middle = float(run.stick_time[np.argmin(np.abs(run.x))])
    known["first_stick"] = middle if math.isfinite(middle) else math.inf
    if math.isfinite(scene.trail):
        # The run was too short to follow the middle until it sticks.
        known["first_stick"] = math.nan
    sticks = np.where(np.isfinite(run.stick_time), run.stick_time, math.inf)
    known["earliest_stick"] = float(sticks.min())
    known["earliest_stick_position"] = float(abs(run.x[np.argmin(sticks)]))
    known["energy_residual"] = run.energy_residual
    known["end"] = side * float((side * run.x[np.isfinite(run.release_time)]).max())
    rows = []
    for station, position in enumerate(positions, start=1):
        distance = np.abs(run.x - position)
        near, about = distance <= 0.5 * scene.nucleation, distance <= scene.nucleation
        slid, released = (run.stick_time - run.release_time)[near], run.release_time[about]
        row = {"station": station, "sample_position": position, "speed": math.nan}
        if np.isfinite(released).all():
            row["speed"] = 1.0 / abs(np.polyfit(run.x[about], released, 1)[0])
        row["pulse_width"] = row["speed"] * float(slid.mean())
        rows.append(known | row | {"pulse_slip": float(run.slip[near].mean())})
    return rows


def one_dimension(scene: LayerScene) -> dict[str, float]:
    """Return the numbers of the paper's equation for the parameters of a scene."""
    tau0, gamma = scene.prestress.right, scene.gamma
    weakening = scene.weakening
    paper, damped = paper_pulse(tau0, gamma), weakening_pulse(tau0, gamma, BETA, weakening)
    return {
        "paper_speed": paper.speed,
        "paper_pulse_width": paper.width,
        "paper_pulse_slip": paper.slip,
        "damped_speed": damped.speed,
        "damped_pulse_width": damped.width,
        "damped_pulse_slip": damped.slip,
        "balance_pulse_slip": undamped_weakening_slip(tau0, gamma, weakening),
    }


def field(scene: LayerScene) -> pd.DataFrame:
    """Return the horizontal velocity in the layer at the end of a scene, where anything moves."""
    run = simulate_layer(scene)
    ahead = run.x <= scene.duration + 2.0 * scene.nucleation
    columns = np.flatnonzero(ahead)[::DRAWN_EVERY_CELLS]
    rows = np.arange(0, scene.cells + 1, DRAWN_EVERY_CELLS)
    y, x = np.meshgrid(rows / scene.cells, run.x[columns], indexing="ij")
    velocity = run.velocity[np.ix_(rows, columns)]
    shape = {"x": x.ravel(), "y": y.ravel(), "velocity": velocity.ravel()}
    numbers = {"gamma": scene.gamma, "tau0": scene.prestress.right, "weakening": scene.weakening}
    numbers["fracture_energy"] = DRAWN_ENERGY
    return pd.DataFrame(shape).assign(part="field", time=scene.duration, **numbers)
