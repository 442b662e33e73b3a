"""Small sweeps for tests."""

import copy

from slippulse.configuration.resolve import resolve

# A few points of each list are enough to draw.
THIN = {"left": 4, "gamma": 4, "width": 3, "damping_ratio": 3, "dx": 3}


def small_sweep(config: dict, name: str) -> dict:
    """Resolve a simulation at preset draft, with the ends and a few between of each long list."""
    block = copy.deepcopy(config["simulations"][name])
    for key, count in THIN.items():
        values = block.get(key, [])
        if not name.startswith("regimes") and len(values) > count:
            step = (len(values) - 1) / (count - 1)
            block[key] = [values[round(i * step)] for i in range(count)]
    return resolve(block, config["model"], config["presets"]["draft"])
