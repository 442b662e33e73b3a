"""Run the scenes of one simulation, or of one chunk of it, on lattices, and write their data."""

import sys
from collections import Counter
from collections.abc import Callable
from functools import partial

from ..configuration.expand import expand
from ..data.store import save_dataset
from ..data.variables import described
from ..simulation.sweep import solve_sweep
from ..solver.solution import solve_on_lattice


def simulate(solve: Callable, files: dict, outputs: dict, settings: dict) -> None:
    """Outputs: data. Settings: simulation (its name), sweep (resolved), threads, progress."""
    sweep, threads = settings["sweep"], settings["threads"]
    scenes, samples = expand(sweep)
    data = solve_sweep(solve, scenes, samples, sweep["record"], threads, settings.get("progress"))
    flags = Counter(filter(None, data["run_flags"].values))
    for kind in sorted(flags):
        flagged = f"{flags[kind]} of {len(scenes)} runs are flagged {kind}, run by run in the data"
        sys.stderr.write(f"  {settings['simulation']}: {flagged}\n")
    save_dataset(described(data), outputs["data"])


run = partial(simulate, solve_on_lattice)
