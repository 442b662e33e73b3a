"""Solve the scenes of one simulation, or of one chunk of it, and write their data."""

import sys
from collections import Counter
from pkgutil import resolve_name

from slippulse.data.saving import save_dataset
from slippulse.data.sweeps import with_run_labels
from slippulse.data.variables import with_descriptions
from slippulse.simulation.sweep import solve_sweep

from ..configuration.expand import expand
from ..configuration.runs import profile_labels

# Module and function that solve the scenes of each scheme. A job depends only on the solver that it
# runs. After an edit of the theory, only the exact solutions (`continuum`) are computed again.
SOLVERS = {
    "localised": "slippulse.solver.solution:solve_on_lattice",
    "fixed_step": "slippulse.solver.fixed_step:solve_by_scheme",
    "continuum": "slippulse.simulation.continuum:solve_exactly",
}


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Solve all scenes of the resolved simulation ``sweep`` in the settings, and write ``data``.

    The settings also have the name of the simulation, the solver (an entry of SOLVERS), the number
    of threads, and a function that reports the progress.
    """
    solve, sweep = resolve_name(settings["solver"]), settings["sweep"]
    scenes, samples = expand(sweep)
    data = solve_sweep(
        solve,
        scenes,
        samples,
        record=sweep["record"],
        threads=settings["threads"],
        progress=settings.get("progress"),
    )
    # Add the number and the seed of each run's profile, if the profiles are tables of pre-stress.
    data = with_run_labels(data, profile_labels(sweep), sweep["record"])
    flags = [flag for flag in data["run_flags"].values if flag]
    for flag, count in sorted(Counter(flags).items()):
        flagged = f"{count} of {len(scenes)} runs have the flag {flag} (in run_flags)"
        sys.stderr.write(f"  {settings['simulation']}: {flagged}\n")
    # Add units and descriptions of the variables.
    save_dataset(with_descriptions(data), outputs["data"])
