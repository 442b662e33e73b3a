"""Checks of rough ensembles: finer lattices, longer tracks, exact solutions, and the memory."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import pandas as pd

from slippulse.data.points import Recorded
from slippulse.simulation.exact_rupture import exact_rupture
from slippulse.solver.solution import solve_on_lattice
from slippulse.theory.pulse import steady_pulse
from slippulse.theory.rupture import Rupture

from ..configuration.expand import expand
from .rough_prestress import KEYS, MIDDLES, START, fate, integral
from .rough_theory import balance_position
from .survival_statistics import Fate, death_rate

NEEDS = {"sweeps": ["rough_displacement", "rough_settling", "rough_stress"]}

# Seeds of each ensemble whose deaths are compared between spacings.
GRID_SEEDS, GRID_SPACINGS = 10, (0.05, 0.025)
# Tracks and durations that are this many times longer, their seeds, and the spacing of the lattice.
LONGER, LENGTH_SEEDS, LENGTH_SPACING = 2, 20, 0.1
# Seeds whose deaths with the stress held are compared with the balance, up to a time, by spacing.
BALANCE_SEEDS, BALANCE_TIME, BALANCE_SPACINGS = 20, 60.0, (0.1, 0.05, 0.025)
# Seeds that are also solved exactly, up to a time, against lattices of these spacings, at blocks at
# this distance from each other.
EXACT_SEEDS, EXACT_TIME, EXACT_SPACINGS = 2, 12.0, (0.05, 0.025)
EXACT_DISTANCE = 0.5
# Bump of the pre-stress that a pulse forgets, the seeds that meet it, and distances beyond the bump
# in units of the memory. A Gaussian ends EDGE widths from its centre.
BUMP, EDGE = (15.0, 0.1, 1.0), 3.0
BUMP_SEEDS, BEYOND = 10, np.linspace(0.1, 1.4, 14)


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """Parts grid, length (death rates), balance (deaths), exact (slip) and memory (of a bump)."""
    dying, settling, stress = (settings["sweeps"][name] for name in NEEDS["sweeps"])
    parts = [
        grid(dying),
        length(dying),
        balance(next(ensembles(stress)), stress),
        *(exact(group, settling) for group in ensembles(settling)),
    ]
    parts += [memory(group, settling) for group in ensembles(settling)]
    return pd.concat(parts, ignore_index=True)


def ensembles(sweep: Mapping[str, Any]) -> Iterator[list[dict]]:
    """Yield the profiles of each ensemble of a sweep."""
    groups: dict[tuple, list[dict]] = {}
    for profile in sweep["profiles"]:
        groups.setdefault(tuple(profile["rough"][key] for key in KEYS), []).append(profile)
    yield from groups.values()


def keys_of(group: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """Parameters that the profiles of an ensemble have in common."""
    return {key: group[0]["rough"][key] for key in KEYS}


def grid(sweep: Mapping[str, Any]) -> pd.DataFrame:
    """Death rate over some seeds of all ensembles on lattices of several spacings."""
    profiles = [one for group in ensembles(sweep) for one in group[:GRID_SEEDS]]
    rows = []
    for dx in GRID_SPACINGS:
        fates = []
        for scene in expand({**sweep, "profiles": profiles, "dx": [dx]})[0]:
            solution = solve_on_lattice(scene)
            run = Recorded(solution.arrays(), {"dx": dx})
            fates += [fate(run, side, profiles[0]["rough"]["stop"]) for side in (1, -1)]
        rows.append({"part": "grid", "dx": dx} | death_rate(fates, START))
    return pd.DataFrame(rows)


def length(sweep: Mapping[str, Any]) -> pd.DataFrame:
    """Return the death rates in the first and in the second half of longer tracks and runs.

    The column stop has the end of each half.
    """
    profiles = [one for group in ensembles(sweep) for one in group[:LENGTH_SEEDS]]
    middle = profiles[0]["rough"]["stop"]
    end = LONGER * middle
    longer = []
    for one in profiles:
        rough = one["rough"]
        longer.append({**one, "rough": {**rough, "start": LONGER * rough["start"], "stop": end}})
    duration = {"time": LONGER * sweep["duration"]["time"]}
    dx = LENGTH_SPACING
    scenes, _ = expand({**sweep, "profiles": longer, "duration": duration, "dx": [dx]})
    fates = []
    for scene in scenes:
        run = Recorded(solve_on_lattice(scene).arrays(), {})
        fates += [fate(run, side, end) for side in (1, -1)]
    # A pulse that goes beyond the first half is no longer followed there.
    first = [Fate(min(one.distance, middle), one.died and one.distance < middle) for one in fates]
    rows = [death_rate(first, START) | {"stop": middle}, death_rate(fates, middle) | {"stop": end}]
    return pd.DataFrame(rows).assign(part="length", dx=dx)


def balance(group: Sequence[Mapping[str, Any]], sweep: Mapping[str, Any]) -> pd.DataFrame:
    """Median distance by which pulses on lattices die before the balance of the pre-stress."""
    rows = []
    profiles = group[:BALANCE_SEEDS]
    exact_deaths = [balance_position(MIDDLES, integral(profile)) for profile in profiles]
    shorter = {**sweep, "profiles": profiles, "duration": {"time": BALANCE_TIME}}
    for dx in BALANCE_SPACINGS:
        gaps = []
        for scene, death in zip(expand({**shorter, "dx": [dx]})[0], exact_deaths, strict=True):
            one = fate(
                Recorded(solve_on_lattice(scene).arrays(), {"dx": dx}), 1, group[0]["rough"]["stop"]
            )
            gaps += [death - one.distance] if one.died else []
        counts = {"deaths": len(gaps), "pulses": len(profiles)}
        rows.append({"part": "balance", "dx": dx, "change": np.median(gaps)} | counts)
    return pd.DataFrame(rows).assign(**keys_of(group))


def exact(group: Sequence[Mapping[str, Any]], sweep: Mapping[str, Any]) -> pd.DataFrame:
    """Median deviation of the final slip on lattices from the exact solution, by spacing."""
    shorter = {**sweep, "profiles": group[:EXACT_SEEDS], "duration": {"time": EXACT_TIME}}
    ruptures: list[Rupture] = []
    rows = []
    for dx in EXACT_SPACINGS:
        scenes = expand({**shorter, "dx": [dx]})[0]
        # The exact solution has no spacing, only the damping ratio.
        ruptures = ruptures or [exact_rupture(scene) for scene in scenes]
        deviations = []
        for scene, rupture in zip(scenes, ruptures, strict=True):
            solution = solve_on_lattice(scene)
            at = np.isfinite(solution.stick_time)
            at[at] = np.arange(np.sum(at)) % round(EXACT_DISTANCE / dx) == 0
            slip = rupture.final_slip(solution.x[at])
            deviations.append(np.abs(solution.slip[at] / slip - 1.0))
        change = float(np.nanmedian(np.concatenate(deviations)))
        rows.append({"part": "exact", "dx": dx, "change": change} | keys_of(group))
    return pd.DataFrame(rows)


def memory(group: Sequence[Mapping[str, Any]], sweep: Mapping[str, Any]) -> pd.DataFrame:
    """Change of the final slip by a bump, over the distance beyond it in units of the memory."""
    plain = [dict(one) for one in group[:BUMP_SEEDS]]
    slips = []
    for profiles in (plain, [one | {"bumps": [list(BUMP)]} for one in plain]):
        scenes = expand({**sweep, "profiles": profiles})[0]
        pulse = steady_pulse(
            group[0]["rough"]["level"], scenes[0].gamma, damping_ratio=scenes[0].damping_ratio
        )
        length = pulse.width / (pulse.speed - 1.0)
        at = BUMP[0] + EDGE * BUMP[2] + length * BEYOND
        solutions = [solve_on_lattice(scene) for scene in scenes]
        slips.append(np.array([np.interp(at, one.x, one.slip) for one in solutions]))
    change = np.abs(slips[1] / slips[0] - 1.0)
    columns = {"distance": BEYOND, "change": np.median(change, axis=0), "high": change.max(axis=0)}
    return pd.DataFrame(columns).assign(part="memory", **keys_of(group))
