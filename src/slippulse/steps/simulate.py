"""Run the scenes of one simulation on lattices, or those of one chunk of it, and write their data."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping

from ..configuration.expand import expand
from ..data.store import save_dataset
from ..simulation.pool import run_all
from ..solver.run import run_scene


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Outputs: data. Settings: simulation (its name), sweep (resolved), threads, progress (of `run_sweep`)."""
    simulate(run_scene, outputs, settings)


def simulate(solve: Callable, outputs: Mapping, settings: Mapping) -> None:
    """The same by a solver of one scene."""
    name, sweep = settings["simulation"], settings["sweep"]
    scenes, samples = expand(sweep)
    data = run_all(solve, scenes, samples, sweep["record"], settings["threads"], settings.get("progress"))
    flags = [flag for flag in data["run_flags"].values if flag]
    for kind in sorted(set(flags)):
        sys.stderr.write(
            f"  {name}: {flags.count(kind)} of {len(scenes)} runs are flagged {kind}, run by run in the data\n"
        )
    save_dataset(data, outputs["data"])
