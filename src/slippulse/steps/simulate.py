"""Run the scenes of one simulation on lattices, or those of one chunk of it, and write their data."""

import sys
from collections import Counter
from collections.abc import Callable
from functools import partial

from ..configuration.expand import expand
from ..data.store import save_dataset
from ..data.variables import described
from ..simulation.runs import run_all
from ..solver.run import run_scene


def simulate(solve: Callable, files: dict, outputs: dict, settings: dict) -> None:
    """Outputs: data. Settings: simulation (its name), sweep (resolved), threads, progress (of `run_sweep`)."""
    sweep = settings["sweep"]
    scenes, samples = expand(sweep)
    data = run_all(
        solve, scenes, samples, sweep["record"], settings["threads"], settings.get("progress")
    )
    flags = Counter(filter(None, data["run_flags"].values))
    for kind in sorted(flags):
        what = f"{flags[kind]} of {len(scenes)} runs are flagged {kind}, run by run in the data"
        sys.stderr.write(f"  {settings['simulation']}: {what}\n")
    save_dataset(described(data), outputs["data"])


run = partial(simulate, run_scene)
