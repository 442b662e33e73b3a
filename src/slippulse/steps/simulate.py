"""Run the scenes of one simulation, or of one chunk of it, and write their data."""

from __future__ import annotations

import sys
import time
from collections.abc import Mapping

from ..configuration.expand import expand
from ..data.store import save_dataset
from ..simulation.sweep import run_sweep

# Seconds between two lines of progress.
BETWEEN_LINES = 2.0


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Outputs: data. Settings: simulation (its name), sweep (resolved), threads."""
    name, sweep = settings["simulation"], settings["sweep"]
    scenes, samples = expand(sweep)
    shown = time.monotonic()

    def progress(done: int, total: int) -> None:
        nonlocal shown
        if done < total and time.monotonic() - shown > BETWEEN_LINES:
            shown = time.monotonic()
            sys.stderr.write(f"  {name}: {done} of {total} runs\n")
            sys.stderr.flush()

    data = run_sweep(scenes, samples, sweep["record"], settings["threads"], progress)
    flags = [flag for flag in data["flags"].values if flag]
    for kind in sorted(set(flags)):
        sys.stderr.write(
            f"  {name}: {flags.count(kind)} of {len(scenes)} runs are flagged {kind}, run by run in the data\n"
        )
    save_dataset(data, outputs["data"])
