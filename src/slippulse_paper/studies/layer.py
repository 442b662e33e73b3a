"""Simulate the layer in two dimensions, and compare its pulses with the paper's formulas.

The layer has the height 1. The fault is its bottom, whose strength falls linearly with slip, from 1
to 0 over the slip d_c (weakening). So the fracture energy is d_c/2. This energy is given as a
fraction of G_0 = tau_0^2/(2 gamma), the energy that a unit length of the layer releases if its
stress falls from the pre-stress to 0. A run is measured at several positions on the fault, which
are called stations, and repeated on finer grids.
"""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from slippulse.model.balance import prestress_balance_position
from slippulse.model.prestress import Prestress
from slippulse.solver.layer import LayerRun, LayerScene, simulate_layer
from slippulse.theory.closed_pulse import paper_pulse
from slippulse.theory.law_pulses import undamped_weakening_slip, weakening_pulse

NEEDS = {"settings": ()}

# Value of gamma if both Lamé constants are equal, and smaller values, at which pulses are wider.
GAMMA = 2.0 / 3.0
GAMMAS = (GAMMA, 0.3, 0.12, 0.06)
# Fracture energies divided by G_0 at the pre-stress LEVEL. Pulses at other levels, and those of the
# parts patch and coupled, have the standard energy.
LEVEL = 0.8
FRACTURE_ENERGIES = (0.05, 0.09, 0.21, 0.42, 0.7, 0.9)
OTHER_LEVELS = (0.5, 0.65, 0.95)
STANDARD_ENERGY = 0.42
# Half-length of the region without friction, in which the rupture starts, and the duration. They
# are the values at GAMMA. At other gamma all lengths and times are multiplied by sqrt(GAMMA/gamma),
# because the width of the paper's pulses is proportional to 1/sqrt(gamma).
NUCLEATION_HALF_LENGTH = 2.0
DURATION = 48.0
# Stations of the part pulse at GAMMA. A pulse is steady if it is the same at the last two.
STATION_POSITIONS = (6.0, 13.0, 16.0)
# Stations at which the same pulses are followed farther, on two or more grids. A pulse has split
# where a point slides for less than this fraction of the time at the first of these stations.
FAR_STATIONS = (16.0, 28.0, 40.0)
SPLIT_FRACTION = 0.5
# The front may become slower beyond the last of STATION_POSITIONS, by this fraction.
SLOWER_FRONT = 0.01
# Stations of most other parts, as fractions of the path of the front.
FRACTIONS_OF_PATH = (0.3, 0.6, 0.85)
# Numbers of cells over the height. Pulses are brittle, and have finer grids, if the length
# gamma d_c, over which the strength falls, is smaller than BRITTLE_LENGTH. If gamma < SMALL_GAMMA,
# grids are coarser. Runs in which the product of the duration and the length of the solved part is
# larger than LONG_RUN have the two coarsest grids only, and are not followed farther. If gamma d_c
# is smaller than VERY_BRITTLE_LENGTH and gamma is not small, pulses have the finest grid, too,
# because some of them split on no coarser one.
CELLS = (10, 20, 40, 80)
BRITTLE_LENGTH = 0.19
VERY_BRITTLE_LENGTH = 0.06
SMALL_GAMMA = 0.2
LONG_RUN = 5000.0
# On a finer grid the last stick may be later, by at most this fraction of its time plus this time.
LATER_RELATIVE, LATER_ABSOLUTE = 0.03, 1.0
# The paper's damping, and a smaller one that shows its influence at GAMMA and LEVEL.
BETA, SMALLER_BETA = 1e-3, 1e-4
# Pre-stress and relative fracture energy of pulses whose top may rise.
FREE_TOP_PULSES = ((0.5, 0.42), (0.5, 0.6), (0.8, 0.42))
# Pre-stress and weakening of a crack under a stress boundary.
CRACK_LEVEL, CRACK_WEAKENING = 0.8, 0.8
# Duration of the parts free and crack at GAMMA. All other parts set their own.
DEFAULT_DURATION = 30.0
# Part barrier: the level that stops the left front under a stress boundary, the width of the
# Gaussian at the nucleation, weakening distances, and the duration.
BARRIER_LEVEL = -0.75
GAUSSIAN_WIDTH = 5.0
WEAKENINGS = (0.05, 0.8)
BARRIER_DURATION = 120.0
# Friction coefficients of a strength that depends on the normal stress, and the duration.
COUPLINGS = (0.1, 0.3, 0.6)
COUPLED_DURATION = 48.0
# Part step: a pulse enters another pre-stress at STEP_POSITION, with this weakening and these
# levels at GAMMA. Its stations lie before and beyond the step.
STEP_POSITION = 10.0
STEP_WEAKENING = 0.3
STEP_LEVELS = (0.65, 0.8)
STEP_STATIONS = (9.0, 11.0, 12.0, 13.5, 15.0, 18.0, 21.0, 24.0, 30.0)
# Part patch: its duration, divided by the time at which a strip that slides uniformly sticks.
PATCH_RELATIVE_DURATION = 1.2
# Part field: fracture energy of the pulse that is drawn, and time of the picture. Along each axis,
# every second node of the grid is drawn.
DRAWN_ENERGY = 0.21
SNAPSHOT_TIME = 12.0
DRAWN_STRIDE = 2

Rows = list[dict[str, Any]]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return one row for each run, grid and station. The column ``part`` has the following values.

    Under a displacement boundary:

    pulse : pulses at several fracture energies and levels
    far : the same pulses, farther away
    damped : those of the part far that split, with the paper's damping
    patch : short runs, until the region in which the rupture starts has stuck
    step : pulses that enter another pre-stress, and for comparison pulses that do not
    free : pulses in a layer whose top is free to rise
    held : the same pulses in a layer whose top is held
    coupled : pulses with a strength that depends on the normal stress

    Under a stress boundary:

    crack : cracks in uniform pre-stress
    barrier : ruptures whose left front is stopped by negative pre-stress

    The part field has the velocities in the layer that the figure shows as a picture.
    """
    rows: Rows = []
    for gamma in GAMMAS:
        rows += pulse_rows(gamma) + patch_rows(gamma)
    for before, level in product(STEP_LEVELS, repeat=2):
        rows += rows_across_a_step(GAMMA, level, STEP_WEAKENING, before, CELLS[1:3])
    rows += free_top_rows() + held_top_rows() + crack_rows() + coupled_rows() + barrier_rows()
    drawn = uniform_scene("displacement", GAMMA, LEVEL, weakening_of(DRAWN_ENERGY, LEVEL, GAMMA))
    field = field_rows(replace(drawn, duration=SNAPSHOT_TIME))
    return pd.concat([pd.DataFrame(rows), field])


def pulse_rows(gamma: float) -> Rows:
    """Return the rows of the parts pulse, far and damped, for all fracture energies and levels.

    Rows of the part pulse also have the exact pulse of the paper's one-dimensional equation.
    """
    cases = [(LEVEL, energy) for energy in FRACTURE_ENERGIES]
    cases += [(tau0, STANDARD_ENERGY) for tau0 in OTHER_LEVELS]
    rows: Rows = []
    for tau0, energy in cases:
        scene = uniform_scene("displacement", gamma, tau0, weakening_of(energy, tau0, gamma))
        near_rows, far_rows = near_and_far_rows(scene)
        theory = one_dimensional_theory(scene)
        rows += [row | theory for row in near_rows] + far_rows
    if gamma == GAMMA:
        # The pulse of the part step that stays in the pre-stress LEVEL is followed farther, too.
        _, far_rows = near_and_far_rows(uniform_scene("displacement", gamma, LEVEL, STEP_WEAKENING))
        rows += far_rows
    return rows


def near_and_far_rows(scene: LayerScene) -> tuple[Rows, Rows]:
    """Return the rows of one pulse at STATION_POSITIONS and, on some grids, at FAR_STATIONS.

    There is one run on each grid. On the grids of `grids_far_away`, it is so long that the pulse
    passes FAR_STATIONS. If the pulse splits in a long run, the run on the next finer grid is also
    long, and damped runs of this length are added on two grids.
    """
    # All lengths are proportional to the width of the pulses, which grows as gamma falls.
    positions = [station * stretch(scene.gamma) for station in STATION_POSITIONS]
    coarsest = CELLS[0]
    # The run on the coarsest grid shows how long the runs to near and far stations must be.
    first_scene = replace(scene, duration=DURATION * stretch(scene.gamma), cells=coarsest)
    first_run = simulate_layer(first_scene)
    near_rows, far_rows = measured_rows("pulse", first_scene, first_run, positions), []
    near_scene = shortened(first_scene, first_run, positions)
    # The speed at the last station gives the time to the stations farther away.
    far_scene = extended(near_scene, speed=near_rows[-1]["speed"])
    far_grids = grids_far_away(near_scene)
    if coarsest in far_grids:
        far_rows += rows_at_far_stations("far", far_scene, simulate_layer(far_scene))
    for cells in finer_grids(near_scene):
        # The last row belongs to the finest grid with a long run so far, and has the split_position
        # of this run.
        split_on_coarser_grid = bool(far_rows) and math.isfinite(far_rows[-1]["split_position"])
        is_followed_far = split_on_coarser_grid or cells in far_grids
        scene = replace(far_scene if is_followed_far else near_scene, cells=cells)
        run = simulate_layer(scene)
        near_rows += measured_rows("pulse", scene, run, positions)
        if is_followed_far:
            far_rows += rows_at_far_stations("far", scene, run)
    if any(math.isfinite(row["split_position"]) for row in far_rows):
        # The paper's damping may prevent the split. Two grids show whether the result converges.
        far_rows += damped_rows(far_scene, far_grids[:2])
    return near_rows, far_rows


def damped_rows(scene: LayerScene, grids: Sequence[int]) -> Rows:
    """Return the rows at FAR_STATIONS of a pulse with the paper's damping, on each grid."""
    rows: Rows = []
    for cells in grids:
        scene = replace(scene, cells=cells, beta=BETA)
        rows += rows_at_far_stations("damped", scene, simulate_layer(scene))
    return rows


def is_brittle(scene: LayerScene) -> bool:
    """Return whether the length gamma d_c, over which the strength falls, is short."""
    return scene.gamma * scene.weakening < BRITTLE_LENGTH


def is_very_brittle(scene: LayerScene) -> bool:
    """Return whether gamma d_c is so short that a pulse may split on the finest grid only."""
    is_short = scene.gamma * scene.weakening < VERY_BRITTLE_LENGTH
    return is_short and scene.gamma > SMALL_GAMMA


def is_long(scene: LayerScene) -> bool:
    """Return whether the run of a scene takes long, given its duration and its trail."""
    return scene.duration * scene.trail > LONG_RUN


def finer_grids(scene: LayerScene) -> Sequence[int]:
    """Return the numbers of cells of the grids for a pulse that are finer than the coarsest grid.

    A pulse is brittle if its strength falls over a short length, which needs a fine grid.

    scene : a scene of the pulse with the duration and the trail that it needs
    """
    # At small gamma pulses are wide and runs are long, so there are fewer grids.
    if scene.gamma < SMALL_GAMMA:
        needs_two = is_brittle(scene) and not is_long(scene)
        return CELLS[1:3] if needs_two else CELLS[1:2]
    needs_three = is_very_brittle(scene) or (is_brittle(scene) and scene.gamma == GAMMA)
    return CELLS[1:4] if needs_three else CELLS[1:3]


def grids_far_away(scene: LayerScene) -> Sequence[int]:
    """Return the numbers of cells of the grids on which a pulse is followed to FAR_STATIONS.

    There is none if the run is long. A pulse is brittle if its strength falls over a short length,
    which needs a fine grid. At small gamma runs are longer, so the grids are coarser.
    """
    if is_long(scene):
        return ()
    if is_very_brittle(scene):
        return CELLS[1:4]
    if scene.gamma == GAMMA or (is_brittle(scene) and scene.gamma > SMALL_GAMMA):
        return CELLS[1:3]
    return CELLS[:2]


def extended(scene: LayerScene, speed: float) -> LayerScene:
    """Return a longer scene, in which the pulse passes the last of FAR_STATIONS.

    In the given scene the pulse passes the last of STATION_POSITIONS. The trail is the length
    behind the waves in which the layer is computed. The trail grows as far as the front falls
    behind the waves.

    speed : front speed of the pulse
    """
    additional_distance = (FAR_STATIONS[-1] - STATION_POSITIONS[-1]) * stretch(scene.gamma)
    # The front may become slower by the fraction SLOWER_FRONT on its way.
    additional_time = (1.0 + SLOWER_FRONT) * additional_distance / speed
    # Waves run at speed 1.
    trail = scene.trail + max(0.0, additional_time - additional_distance)
    return replace(scene, duration=scene.duration + additional_time, trail=trail)


def rows_at_far_stations(part: str, scene: LayerScene, run: LayerRun, side: int = 1) -> Rows:
    """Return the rows of one run at FAR_STATIONS, with columns that show whether the pulse split.

    In a split pulse, points stick early, behind its narrow tip, and later slide again. The argument
    ``part`` is the value of the column part in all rows.

    The columns are:

    split_position : distance at which a point first sticks early, between the first and the last
        station; NaN if none does
    sliding_again : length of the fault beyond the first station that slides again at the end
    """
    station_distances = [station * stretch(scene.gamma) for station in FAR_STATIONS]
    positions = [side * distance for distance in station_distances]
    rows = measured_rows(part, scene, run, positions, side)
    sliding_time_at_first_station = rows[0]["pulse_width"] / rows[0]["speed"]
    sliding_time = run.stick_time - run.release_time
    sticks_early = sliding_time < SPLIT_FRACTION * sliding_time_at_first_station
    distance = side * run.x
    is_beyond_first_station = distance > station_distances[0]
    is_split = is_beyond_first_station & (distance < station_distances[-1]) & sticks_early
    # The first row of velocities is that of the fault, which is the bottom of the layer.
    has_stuck, is_sliding = np.isfinite(run.stick_time), run.velocity[0] > 0.0
    slides_again = is_beyond_first_station & has_stuck & is_sliding
    behaviour = {
        "split_position": float(distance[is_split].min()) if is_split.any() else math.nan,
        "sliding_again": float(slides_again.sum()) / scene.cells,
    }
    return [row | behaviour for row in rows]


def patch_rows(gamma: float) -> Rows:
    """Return one row for each grid, with the time at which the nucleation region sticks.

    The nucleation region is the region without friction around x = 0, in which the rupture starts.
    The column strip_first_stick has the time at which an infinite layer (a strip) that slides
    uniformly would stick. In this time a shear wave runs to the top of the layer and back.
    """
    # The unit of speed is the compressional wave speed, and gamma is 2 G/(lambda + 2 G).
    shear_wave_speed = math.sqrt(0.5 * gamma)
    # The layer has the height 1.
    strip_first_stick = 2.0 / shear_wave_speed
    scene = uniform_scene("displacement", gamma, LEVEL, weakening_of(STANDARD_ENERGY, LEVEL, gamma))
    scene = replace(scene, duration=PATCH_RELATIVE_DURATION * strip_first_stick)
    rows = rows_along_path("patch", scene, CELLS[:3])
    # There is one row for each station of a grid, but the region sticks only once in each run.
    rows = [row for row in rows if row["station"] == 1]
    return [row | {"strip_first_stick": strip_first_stick} for row in rows]


def free_top_rows() -> Rows:
    """Return the rows of pulses in a layer whose top may rise, on the three coarsest grids."""
    rows: Rows = []
    for tau0, energy in FREE_TOP_PULSES:
        scene = uniform_scene("displacement", GAMMA, tau0, weakening_of(energy, tau0, GAMMA))
        rows += rows_along_path("free", replace(scene, top="free"), CELLS[:3])
    return rows


def held_top_rows() -> Rows:
    """Return the rows of the pulses of `free_top_rows`, on the same grids, but with a held top."""
    rows: Rows = []
    for tau0, energy in FREE_TOP_PULSES:
        scene = uniform_scene("displacement", GAMMA, tau0, weakening_of(energy, tau0, GAMMA))
        rows += rows_at_stations("held", scene, CELLS[:3], STATION_POSITIONS)
    return rows


def crack_rows() -> Rows:
    """Return the rows of a crack in uniform pre-stress under a stress boundary."""
    scene = uniform_scene("stress", GAMMA, CRACK_LEVEL, CRACK_WEAKENING)
    return rows_along_path("crack", scene, CELLS[:3])


def coupled_rows() -> Rows:
    """Return the rows of pulses on a fault whose strength depends on the normal stress.

    The coupling is the friction coefficient of this dependence. The pulse on the right and the
    pulse on the left differ, so both are measured.
    """
    weakening = weakening_of(STANDARD_ENERGY, LEVEL, GAMMA)
    scene = uniform_scene("displacement", GAMMA, LEVEL, weakening)
    scene = replace(scene, duration=COUPLED_DURATION)
    rows: Rows = []
    for coupling, cells in product(COUPLINGS, CELLS[1:3]):
        coupled = replace(scene, coupling=coupling, cells=cells)
        run = simulate_layer(coupled)
        for side in (1, -1):
            rows += rows_at_far_stations("coupled", coupled, run, side)
    return rows


def barrier_rows() -> Rows:
    """Return the rows of ruptures under a stress boundary with a negative level on the left.

    This level stops the left front. The column balance_distance has the distance at which the front
    stops according to the paper's equation.
    """
    prestress = Prestress(BARRIER_LEVEL, 0.0, GAUSSIAN_WIDTH)
    balance_distance = abs(prestress_balance_position(prestress))
    rows: Rows = []
    for weakening in WEAKENINGS:
        scene = LayerScene(
            boundary="stress",
            gamma=GAMMA,
            prestress=prestress,
            weakening=weakening,
            duration=BARRIER_DURATION,
            nucleation=NUCLEATION_HALF_LENGTH,
            precision="single",
        )
        rows += rows_along_path("barrier", scene, CELLS[:2], sides=(1, -1))
    return [row | {"balance_distance": balance_distance} for row in rows]


def weakening_of(relative_energy: float, tau0: float, gamma: float) -> float:
    """Return the slip d_c over which the strength falls.

    relative_energy : fracture energy d_c/2, divided by G_0 = tau0^2/(2 gamma)
    """
    return relative_energy * tau0**2 / gamma


def stretch(gamma: float) -> float:
    """Return the factor by which lengths and times at gamma are larger than those at GAMMA."""
    return math.sqrt(GAMMA / gamma)


def uniform_scene(boundary: str, gamma: float, tau0: float, weakening: float) -> LayerScene:
    """Return a scene in uniform pre-stress, whose rupture starts in a region without friction.

    Pulses are wider at smaller gamma, so all lengths and times are multiplied by `stretch`.

    tau0 : the pre-stress
    weakening : slip over which the strength falls
    """
    return LayerScene(
        boundary=boundary,
        gamma=gamma,
        prestress=Prestress(tau0, tau0, peak=tau0),
        weakening=weakening,
        duration=DEFAULT_DURATION * stretch(gamma),
        nucleation=NUCLEATION_HALF_LENGTH * stretch(gamma),
        precision="single",
    )


def rows_across_a_step(
    gamma: float,
    level: float,
    weakening: float,
    before: float,
    grids: Sequence[int],
    stations: Sequence[float] = STEP_STATIONS,
) -> Rows:
    """Measure a pulse that forms in the pre-stress ``before`` and then enters ``level``.

    The pre-stress changes at STEP_POSITION on both sides, or is uniform if both levels are equal.
    The column tau0 has the level that the pulse enters.

    weakening : slip over which the strength falls
    grids : numbers of cells over the height, the coarsest grid first
    stations : measured positions at GAMMA; at another gamma they are farther out by `stretch`
    """
    scene = uniform_scene("displacement", gamma, before, weakening)
    if before != level:
        position = STEP_POSITION * stretch(gamma)
        steps = ((position, level), (-position, level))
        scene = replace(scene, prestress=replace(scene.prestress, steps=steps))
    relative_energy = weakening * gamma / level**2
    levels = {"before": before, "tau0": level, "fracture_energy": relative_energy}
    return [row | levels for row in rows_at_stations("step", scene, grids, stations)]


def rows_at_stations(
    part: str, scene: LayerScene, grids: Sequence[int], stations: Sequence[float]
) -> Rows:
    """Measure a pulse at fixed positions on the fault, on each grid.

    part : value of the column part in all rows
    grids : numbers of cells over the height, the coarsest grid first
    stations : positions at GAMMA; at the gamma of the scene they are farther out by `stretch`
    """
    scene = replace(scene, duration=DURATION * stretch(scene.gamma))
    positions = [station * stretch(scene.gamma) for station in stations]
    rows: Rows = []
    for cells in grids:
        scene = replace(scene, cells=cells)
        run = simulate_layer(scene)
        rows += measured_rows(part, scene, run, positions)
        if cells == grids[0]:
            # The run on the coarsest grid shows how long those on finer grids must be.
            scene = shortened(scene, run, positions)
    return rows


def shortened(scene: LayerScene, run: LayerRun, positions: Sequence[float]) -> LayerScene:
    """Return the scene with a shorter duration and trail, which suffice to measure a pulse.

    The trail is the length behind the waves in which the layer is computed. The scene is returned
    as it is if the pulse does not pass all positions.

    run : the run of the scene on a coarse grid
    """
    # Sliding times are averaged over a window around each position, as long as scene.nucleation.
    half_window = 0.5 * scene.nucleation
    first, last = min(positions) - half_window, max(positions) + half_window
    is_measured = (run.x >= first) & (run.x <= last)
    stick_times = run.stick_time[is_measured]
    if not np.isfinite(stick_times).all():
        return scene
    last_stick = float(stick_times.max())
    # The trailing edge may arrive later on a finer grid.
    margin = LATER_ABSOLUTE + LATER_RELATIVE * last_stick
    # Compressional waves run at speed 1, so this is how far the trailing edge is behind them.
    distance_behind_waves = float((stick_times - run.x[is_measured]).max())
    trail = max(0.0, distance_behind_waves) + margin
    return replace(scene, duration=last_stick + margin, trail=trail)


def rows_along_path(
    part: str, scene: LayerScene, grids: Sequence[int], sides: Sequence[int] = (1,)
) -> Rows:
    """Measure a rupture at FRACTIONS_OF_PATH of the path of its front, on each grid and side.

    part : value of the column part in all rows
    grids : numbers of cells over the height
    sides : 1 for the right side of x = 0, -1 for the left
    """
    rows: Rows = []
    for cells in grids:
        scene = replace(scene, cells=cells)
        run = simulate_layer(scene)
        for side in sides:
            distance = path_length(run, side)
            positions = [side * fraction * distance for fraction in FRACTIONS_OF_PATH]
            rows += measured_rows(part, scene, run, positions, side)
    return rows


def path_length(run: LayerRun, side: int) -> float:
    """Return the distance that the front on one side (1 or -1) has run by the end."""
    released = np.isfinite(run.release_time)
    return float((side * run.x[released]).max())


def measured_rows(
    part: str, scene: LayerScene, run: LayerRun, positions: Sequence[float], side: int = 1
) -> Rows:
    """Return one row for each position, with the parameters and the measured numbers.

    The numbers are those of the whole run and those of the pulse at the position.

    part : value of the column part in all rows
    side : 1 if the positions are on the right side of x = 0, -1 if they are on the left
    """
    tau0, gamma = scene.prestress.right, scene.gamma
    parameters: dict[str, Any] = {
        "part": part,
        "gamma": gamma,
        "tau0": tau0,
        "side": side,
        "weakening": scene.weakening,
        "coupling": scene.coupling,
        "cells": scene.cells,
    }
    # The unit of the fracture energy, G_0, is 0 if the pre-stress is.
    if tau0 > 0.0:
        parameters["fracture_energy"] = scene.weakening * gamma / tau0**2
    numbers_of_run = numbers_of_whole_run(scene, run, side)
    rows = []
    for station, position in enumerate(positions, start=1):
        pulse = pulse_at_station(run, position, window=scene.nucleation)
        rows.append(parameters | numbers_of_run | {"station": station} | pulse)
    return rows


def numbers_of_whole_run(scene: LayerScene, run: LayerRun, side: int) -> dict[str, float]:
    """Return the numbers of a run that do not belong to a station.

    The result contains these numbers:

    first_stick : time at which the middle of the nucleation region sticks. Infinite if it never
        sticks. NaN if the scene has a finite trail, because then the middle is not solved until the
        end: only the part of the layer within this length behind the waves is.
    earliest_stick, earliest_stick_position : time of the first stick anywhere, and its distance
        from x = 0
    largest_velocity : largest slip velocity at the end of the run
    energy_residual : residual of the energy balance
    end : position of the front on the given side (1 for the right, -1 for the left) at the end
    """
    first_stick = float(run.stick_time[np.argmin(np.abs(run.x))])
    if not math.isfinite(first_stick):
        first_stick = math.inf
    if math.isfinite(scene.trail):
        first_stick = math.nan
    stick_times = np.where(np.isfinite(run.stick_time), run.stick_time, math.inf)
    # The first row of velocities is that of the fault, which is the bottom of the layer.
    slip_velocity = run.velocity[0]
    return {
        "first_stick": first_stick,
        "earliest_stick": float(stick_times.min()),
        "earliest_stick_position": float(abs(run.x[np.argmin(stick_times)])),
        "largest_velocity": float(slip_velocity.max()),
        "energy_residual": run.energy_residual,
        "end": side * path_length(run, side),
    }


def pulse_at_station(run: LayerRun, position: float, window: float) -> dict[str, float]:
    """Return speed, width and slip of the pulse that passes a position.

    The width is the front speed multiplied by the mean time for which a point slides. The speed is
    NaN if the front has not passed the position and its surroundings.

    window : length around the position over which sliding times and slips are averaged. The speed
        is fitted over twice this length.
    """
    distance = np.abs(run.x - position)
    in_window, in_wide_window = distance <= 0.5 * window, distance <= window
    sliding_times = (run.stick_time - run.release_time)[in_window]
    release_times = run.release_time[in_wide_window]
    speed = math.nan
    if np.isfinite(release_times).all():
        slowness, _ = np.polyfit(run.x[in_wide_window], release_times, 1)
        speed = 1.0 / abs(slowness)
    return {
        "sample_position": position,
        "speed": speed,
        "pulse_width": speed * float(sliding_times.mean()),
        "pulse_slip": float(run.slip[in_window].mean()),
    }


def one_dimensional_theory(scene: LayerScene) -> dict[str, float]:
    """Return the pulse of the paper's one-dimensional equation, for the parameters of a scene.

    The result contains these numbers:

    paper_... : by the paper's formulas, without weakening and damping
    damped_... : with the weakening of the scene and the damping BETA
    less_damped_pulse_width : width with the damping SMALLER_BETA, at GAMMA and LEVEL only
    balance_pulse_slip : final slip with weakening and without damping, from the energy balance
    """
    tau0, gamma = scene.prestress.right, scene.gamma
    weakening = scene.weakening
    paper = paper_pulse(tau0, gamma)
    damped = weakening_pulse(tau0, gamma, BETA, weakening)
    less_damped_width = math.nan
    if (gamma, tau0) == (GAMMA, LEVEL):
        less_damped_width = weakening_pulse(tau0, gamma, SMALLER_BETA, weakening).width
    return {
        "paper_speed": paper.speed,
        "paper_pulse_width": paper.width,
        "paper_pulse_slip": paper.slip,
        "damped_speed": damped.speed,
        "damped_pulse_width": damped.width,
        "damped_pulse_slip": damped.slip,
        "less_damped_pulse_width": less_damped_width,
        "balance_pulse_slip": undamped_weakening_slip(tau0, gamma, weakening),
    }


def field_rows(scene: LayerScene) -> pd.DataFrame:
    """Return the horizontal velocity in the layer at the end of a scene, at some grid nodes.

    The part of the layer that no wave has reached is left out. The scene has the fracture energy
    DRAWN_ENERGY.
    """
    run = simulate_layer(scene)
    # Waves run at most at speed 1, from the edge of the nucleation region at x = scene.nucleation.
    # The second length of the region is a margin.
    reach = scene.duration + 2.0 * scene.nucleation
    columns = np.flatnonzero(run.x <= reach)[::DRAWN_STRIDE]
    rows = np.arange(0, scene.cells + 1, DRAWN_STRIDE)
    heights = rows / scene.cells
    y, x = np.meshgrid(heights, run.x[columns], indexing="ij")
    velocity = run.velocity[np.ix_(rows, columns)]
    field = pd.DataFrame({"x": x.ravel(), "y": y.ravel(), "velocity": velocity.ravel()})
    return field.assign(
        part="field",
        time=scene.duration,
        gamma=scene.gamma,
        tau0=scene.prestress.right,
        weakening=scene.weakening,
        fracture_energy=DRAWN_ENERGY,
    )
