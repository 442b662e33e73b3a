"""Small sweeps and studies for tests."""

import copy

from slippulse_paper.configuration.resolve import resolve

# Number of values of each list in a small sweep. A few points are enough to draw.
MAX_VALUES = {"left": 4, "gamma": 4, "width": 3, "damping_ratio": 3, "dx": 3}

# Seeds of each ensemble of rough pre-stress.
SEEDS = 12

# Constants of studies in tests: the ends of lists, and runs that are long enough.
SMALL_STUDIES = {
    "barriers": {"RELATIVE_LENGTHS": (0.95, 1.05)},
    "friction_laws": {"LEVELS": (0.2, 0.5, 0.8), "DURATION": 28.0},
    "front_law": {"SPACING_COUNT": 5},
    "layer": {
        "GAMMAS": (2.0 / 3.0, 0.06),
        "OTHER_LEVELS": (0.5,),
        "WEAKENINGS": (0.05, 0.8),
        "FRACTURE_ENERGIES": (0.05, 0.42, 0.9),
    },
    "rough_checks": {
        "GRID_SEEDS": 1,
        "LENGTH_SEEDS": 2,
        "BALANCE_SEEDS": 12,
        "EXACT_SEEDS": 1,
        "BUMP_SEEDS": 3,
    },
    "rough_prestress": {"LONG_SEEDS": 200},
    "published_figure": {
        "DAMPING_RATIOS": {
            "total": (0.055, 0.066, 0.08, 0.096, 0.115),
            "elastic": (0.1, 0.13, 0.169, 0.22, 0.286),
        }
    },
}


def small_sweep(config: dict, name: str) -> dict:
    """Return a resolved simulation at preset draft, with a few values of each long list.

    These are the first value, the last value and some between them.
    """
    simulation = copy.deepcopy(config["simulations"][name])
    for profile in simulation.get("profiles", []):
        seeds = profile.get("rough", {}).get("seed")
        if isinstance(seeds, dict):
            profile["rough"]["seed"] = {"from": 1, "to": SEEDS}
    for key, count in MAX_VALUES.items():
        values = simulation.get(key, [])
        if not name.startswith("regimes") and len(values) > count:
            step = (len(values) - 1) / (count - 1)
            simulation[key] = [values[round(i * step)] for i in range(count)]
    return resolve(simulation, config["model"], config["presets"]["draft"])
