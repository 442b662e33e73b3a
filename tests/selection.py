"""What a step of the workflow gets of the configuration, and small sweeps for tests."""

import copy
from collections.abc import Iterable

from slippulse.configuration.resolve import resolve

# A few points of each list are enough to draw.
THIN = {"left": 4, "gamma": 4, "width": 3, "damping_ratio": 3, "dx": 3}


def selected(config: dict, keys: Iterable[str], own: dict) -> dict:
    """What a step gets: the declared keys of the configuration alone, nested as there, beside its own values."""
    found = copy.deepcopy(own)
    for key in keys:
        *parents, last = key.split(".")
        inside, value = found, config
        for parent in parents:
            inside, value = inside.setdefault(parent, {}), value[parent]
        inside[last] = value[last]
    return found


def small_sweep(config: dict, name: str) -> dict:
    """A simulation at preset draft with the first, the last and a few evenly between of each list, but of regimes."""
    block = copy.deepcopy(config["simulations"][name])
    for key, count in THIN.items():
        values = block.get(key, [])
        if not name.startswith("regimes") and len(values) > count:
            step = (len(values) - 1) / (count - 1)
            block[key] = [values[round(i * step)] for i in range(count)]
    return resolve(block, config["model"], config["presets"]["draft"])
