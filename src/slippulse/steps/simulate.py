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
    began = shown = time.monotonic()

    def progress(done: float, total: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if 0 < done < total and now - shown > BETWEEN_LINES:
            shown = now
            left = (now - began) * (total / done - 1.0)
            part = f"{done:.0%} of the run" if total == 1 else f"{done} of {total} runs"
            sys.stderr.write(f"  {name}: {part}, about {left:.0f} s left\n")
            sys.stderr.flush()

    data = run_sweep(scenes, samples, sweep["record"], settings["threads"], progress)
    flags = [flag for flag in data["run_flags"].values if flag]
    for kind in sorted(set(flags)):
        sys.stderr.write(
            f"  {name}: {flags.count(kind)} of {len(scenes)} runs are flagged {kind}, run by run in the data\n"
        )
    save_dataset(data, outputs["data"])
