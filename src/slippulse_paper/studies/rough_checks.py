"""Check the results of `rough_prestress` on some seeds of its ensembles.

The checks are the parts of the table:

grid : death rates on finer lattices
length : death rates on longer tracks
balance : positions at which pulses die under a stress boundary, compared with theory
exact : final slip, compared with the exact solution
memory : distance beyond a bump of the pre-stress up to which the final slip depends on the bump
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from slippulse.data.points import Recorded
from slippulse.model.scene import Scene
from slippulse.simulation.exact_rupture import exact_rupture
from slippulse.solver.solution import solve_on_lattice
from slippulse.theory.pulse import steady_pulse
from slippulse.theory.rupture import Rupture

from ..configuration.expand import expand
from ..configuration.profiles import ExpandedProfiles
from .rough_prestress import CELL_MIDDLES, ROUGH_KEYS, START, fate_of_pulse, prestress_integral
from .rough_theory import LOWEST_LEVEL, balance_position
from .survival_statistics import Fate, death_rate

NEEDS = {"sweeps": ["rough_displacement", "rough_settling", "rough_stress"]}

# Part grid: seeds of each ensemble, and spacings of the lattices.
GRID_SEEDS = 10
GRID_SPACINGS = (0.05, 0.025)
# Part length: factor of the track and of the duration, seeds, and spacing.
LENGTH_FACTOR = 2
LENGTH_SEEDS = 20
LENGTH_SPACING = 0.1
# Part balance: seeds, duration and spacings.
BALANCE_SEEDS = 20
BALANCE_DURATION = 60.0
BALANCE_SPACINGS = (0.1, 0.05, 0.025)
# Part exact: seeds, duration and spacings, and the distance between the blocks that are compared.
EXACT_SEEDS = 2
EXACT_DURATION = 12.0
EXACT_SPACINGS = (0.05, 0.025)
COMPARED_BLOCK_DISTANCE = 0.5
# Part memory: seeds, and the bump, which is a Gaussian. It ends, for all practical purposes, at
# this number of widths from its position.
BUMP_SEEDS = 10
BUMP_POSITION = 15.0
BUMP_HEIGHT = 0.1
BUMP_WIDTH = 1.0
BUMP_REACH_IN_WIDTHS = 3.0
# The slip is compared at these distances beyond the end of the bump, in units of the memory.
RELATIVE_DISTANCES = np.linspace(0.1, 1.4, 14)

# One rough pre-stress of the configuration, with its seed.
Profile = Mapping[str, Any]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Return the rows of all checks. The column ``part`` has the name of the check."""
    sweeps = settings["sweeps"]
    parts = [grid_rows(sweeps["rough_displacement"]), length_rows(sweeps["rough_displacement"])]
    first_ensemble_under_stress = next(ensembles_of(sweeps["rough_stress"]))
    parts.append(balance_rows(first_ensemble_under_stress, sweeps["rough_stress"]))
    # In this sweep the pre-stress varies little, and pulses do not die.
    settling = sweeps["rough_settling"]
    # Only these ensembles have steady pulses.
    with_pulses = [
        ensemble
        for ensemble in ensembles_of(settling)
        if parameters_of(ensemble)["level"] >= LOWEST_LEVEL
    ]
    parts += [exact_rows(ensemble, settling) for ensemble in with_pulses]
    parts += [memory_rows(ensemble, settling) for ensemble in with_pulses]
    return pd.concat(parts, ignore_index=True)


def ensembles_of(sweep: Mapping[str, Any]) -> Iterator[list[Profile]]:
    """Yield the profiles of each ensemble of a sweep, which differ only in the seed."""
    ensembles: dict[tuple, list[Profile]] = {}
    for profile in ExpandedProfiles(sweep["profiles"]):
        key = tuple(profile["rough"][name] for name in ROUGH_KEYS)
        ensembles.setdefault(key, []).append(profile)
    yield from ensembles.values()


def parameters_of(ensemble: Sequence[Profile]) -> dict[str, Any]:
    """Return the parameters of the random field, which all profiles of an ensemble share."""
    return {name: ensemble[0]["rough"][name] for name in ROUGH_KEYS}


def scenes_of(
    sweep: Mapping[str, Any], profiles: Sequence[Profile], **changed: Any
) -> Sequence[Scene]:
    """Return the scenes of a sweep with these profiles, and with some keys of the sweep changed.

    The lattice solver of the checks has the localised scheme, also if the sweep has another one.
    """
    scenes, _ = expand({**sweep, "profiles": profiles, "scheme": "localised", **changed})
    return scenes


def simulated_run(scene: Scene) -> Recorded:
    """Simulate a scene on its lattice."""
    return Recorded(solve_on_lattice(scene).arrays(), {"dx": scene.dx})


def grid_rows(sweep: Mapping[str, Any]) -> pd.DataFrame:
    """Return the death rate on lattices of several spacings, over some seeds of all ensembles."""
    rows = []
    for dx in GRID_SPACINGS:
        fates: list[Fate] = []
        for ensemble in ensembles_of(sweep):
            scenes = scenes_of(sweep, ensemble[:GRID_SEEDS], dx=[dx])
            fates += fates_on_both_sides(scenes, end_of_track=ensemble[0]["rough"]["stop"])
        # Deaths are counted from START on, which is beyond the region that the nucleation reaches.
        rows.append({"part": "grid", "dx": dx} | death_rate(fates, START))
    return pd.DataFrame(rows)


def fates_on_both_sides(scenes: Sequence[Scene], end_of_track: float) -> list[Fate]:
    """Simulate scenes, and return the fates of their left and right pulses.

    end_of_track : distance at which the rough pre-stress ends on both sides
    """
    fates = []
    for scene in scenes:
        run = simulated_run(scene)
        fates += [fate_of_pulse(run, side, stop=end_of_track) for side in (1, -1)]
    return fates


def length_rows(sweep: Mapping[str, Any]) -> pd.DataFrame:
    """Return the death rates in both halves of longer tracks, over some seeds of all ensembles.

    A track is the region of rough pre-stress. Tracks and duration are LENGTH_FACTOR times as long
    as in the study. The column stop has the end of each half. Tracks of different lengths have
    rows of their own.
    """
    duration = {unit: LENGTH_FACTOR * number for unit, number in sweep["duration"].items()}
    fates_by_end: dict[float, list[Fate]] = {}
    for ensemble in ensembles_of(sweep):
        profiles = [with_longer_track(profile) for profile in ensemble[:LENGTH_SEEDS]]
        scenes = scenes_of(sweep, profiles, duration=duration, dx=[LENGTH_SPACING])
        end = profiles[0]["rough"]["stop"]
        fates_by_end.setdefault(end, []).extend(fates_on_both_sides(scenes, end))
    rows = []
    for end, fates in fates_by_end.items():
        middle = end / LENGTH_FACTOR
        # A pulse that leaves the first half alive counts as alive at the end of this half.
        fates_in_first_half = [
            Fate(min(fate.distance, middle), fate.died and fate.distance < middle) for fate in fates
        ]
        rows.append({"stop": middle} | death_rate(fates_in_first_half, start=START))
        rows.append({"stop": end} | death_rate(fates, start=middle))
    return pd.DataFrame(rows).assign(part="length", dx=LENGTH_SPACING)


def with_longer_track(profile: Profile) -> Profile:
    """Return a profile whose rough pre-stress reaches LENGTH_FACTOR times as far on both sides."""
    rough = profile["rough"]
    ends = {name: LENGTH_FACTOR * rough[name] for name in ("start", "stop")}
    return {**profile, "rough": {**rough, **ends}}


def balance_rows(ensemble: Sequence[Profile], sweep: Mapping[str, Any]) -> pd.DataFrame:
    """Compare where pulses die on lattices and by theory, with one row for each spacing.

    By theory the right pulse dies at its balance position: the integral of the pre-stress, from
    where the left front stopped to this position, is 0. On a lattice it dies before it gets there.
    The column change has the median distance between the two positions, over all right pulses that
    die within BALANCE_DURATION.
    """
    profiles = ensemble[:BALANCE_SEEDS]
    integrals = [prestress_integral(profile) for profile in profiles]
    balance_positions = [balance_position(CELL_MIDDLES, integral) for integral in integrals]
    # The rough pre-stress ends at this distance, which all profiles of an ensemble share.
    end_of_track = ensemble[0]["rough"]["stop"]
    rows = []
    for dx in BALANCE_SPACINGS:
        scenes = scenes_of(sweep, profiles, dx=[dx], duration={"time": BALANCE_DURATION})
        gaps = []
        for scene, balance in zip(scenes, balance_positions, strict=True):
            right_pulse = fate_of_pulse(simulated_run(scene), side=1, stop=end_of_track)
            if right_pulse.died:
                gaps.append(balance - right_pulse.distance)
        row = {"part": "balance", "dx": dx, "change": np.median(gaps)}
        rows.append(row | {"deaths": len(gaps), "pulses": len(profiles)})
    return pd.DataFrame(rows).assign(**parameters_of(ensemble))


def exact_rows(ensemble: Sequence[Profile], sweep: Mapping[str, Any]) -> pd.DataFrame:
    """Compare the final slip on lattices with the exact solution, one row for each spacing.

    The column change has the median of |lattice/exact - 1| over some blocks of some seeds.
    """
    profiles = ensemble[:EXACT_SEEDS]
    ruptures: list[Rupture] = []
    rows = []
    for dx in EXACT_SPACINGS:
        scenes = scenes_of(sweep, profiles, dx=[dx], duration={"time": EXACT_DURATION})
        if not ruptures:
            # The exact solution depends on the damping ratio and not on the spacing, so all
            # lattices are compared with the same one.
            ruptures = [exact_rupture(scene) for scene in scenes]
        stride = round(COMPARED_BLOCK_DISTANCE / dx)
        deviations = []
        for scene, rupture in zip(scenes, ruptures, strict=True):
            solution = solve_on_lattice(scene)
            stuck_blocks = np.flatnonzero(np.isfinite(solution.stick_time))
            compared = stuck_blocks[::stride]
            exact_slip = rupture.final_slip(solution.x[compared])
            deviations.append(np.abs(solution.slip[compared] / exact_slip - 1.0))
        # A deviation is NaN where the point still slides in the exact solution.
        median = float(np.nanmedian(np.concatenate(deviations)))
        row = {"part": "exact", "dx": dx, "change": median}
        rows.append(row | parameters_of(ensemble))
    return pd.DataFrame(rows)


def memory_rows(ensemble: Sequence[Profile], sweep: Mapping[str, Any]) -> pd.DataFrame:
    """Return how much a bump of the pre-stress changes the final slip beyond it.

    There is one row for each of RELATIVE_DISTANCES, which are in units of the memory, within which
    a pulse forgets what it met. The column change has the median over some seeds of the relative
    change, and the column high has the largest one.
    """
    plain = [dict(profile) for profile in ensemble[:BUMP_SEEDS]]
    bump = [BUMP_POSITION, BUMP_HEIGHT, BUMP_WIDTH]
    with_bump = [profile | {"bumps": [bump]} for profile in plain]
    slip, slip_with_bump = (slip_beyond_bump(sweep, profiles) for profiles in (plain, with_bump))
    change = np.abs(slip_with_bump / slip - 1.0)
    columns = {
        "distance": RELATIVE_DISTANCES,
        "change": np.median(change, axis=0),
        "high": change.max(axis=0),
    }
    return pd.DataFrame(columns).assign(part="memory", **parameters_of(ensemble))


def slip_beyond_bump(sweep: Mapping[str, Any], profiles: Sequence[Profile]) -> np.ndarray:
    """Return the final slip at RELATIVE_DISTANCES beyond the bump, with one row per profile.

    The distances are in units of the memory, within which a pulse forgets what it met. They are
    the same for profiles without the bump.
    """
    scenes = scenes_of(sweep, profiles)
    # All scenes have the same level, elasticity ratio, damping ratio and release rule.
    scene, level = scenes[0], profiles[0]["rough"]["level"]
    pulse = steady_pulse(
        level, scene.gamma, damping_ratio=scene.damping_ratio, release=scene.release
    )
    memory = pulse.width / (pulse.speed - 1.0)
    end_of_bump = BUMP_POSITION + BUMP_REACH_IN_WIDTHS * BUMP_WIDTH
    positions = end_of_bump + memory * RELATIVE_DISTANCES
    solutions = [solve_on_lattice(scene) for scene in scenes]
    return np.array([np.interp(positions, solution.x, solution.slip) for solution in solutions])
