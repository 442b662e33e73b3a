# The checked configuration, and the files and settings that rules share.

import os
import re
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path

from slippulse.claims.reading import read_entries
from slippulse.configuration.accuracy import promised
from slippulse.configuration.altered import Alterations
from slippulse.configuration.runs import run_count
from slippulse.configuration.limits import bound_of_sweep
from slippulse.configuration.problems import ConfigError
from slippulse.configuration.read import read_config, read_overlay
from slippulse.configuration.resolve import accuracy_of, all_simulations, resolve
from slippulse.steps.origins import below
from slippulse.steps.processes import JobFailed, Jobs, end_with
from slippulse.steps.reach import declared, needs_of, sources
from slippulse.steps.targets import SOURCES, selected

JOBS, FAILED = Jobs(), []
if workflow.is_main_process and "SLIPPULSE_LEASH" in os.environ:
    end_with(int(os.environ.pop("SLIPPULSE_LEASH")))
# Inputs of each figure and study, as its module says: names by kind of file, and keys.
NEEDS, STUDY_NEEDS = needs_of("figures"), needs_of("studies")
try:
    # `configfile:` reads YAML 1.1 and names no line.
    SHIPPED = read_overlay(f"{workflow.basedir}/config/config.yaml")
    OVERLAYS = [read_overlay(path) for path in workflow.overwrite_configfiles]
    # A job on another node starts Snakemake again; its scenes were checked here.
    said = workflow.config_settings.config
    CONFIG = read_config(SHIPPED, OVERLAYS, said, workflow.is_main_process)
    if CONFIG.claims:
        read_entries("manuscript/claims.yaml", CONFIG.given()["claims"])
    if unknown := sorted({*(CONFIG.studies or ())} - {*STUDY_NEEDS}):
        raise ConfigError(f"studies: {', '.join(unknown)}; allowed: {', '.join(STUDY_NEEDS)}")
except ValueError as error:
    sys.exit(f"The configuration is refused:\n{error}")

config = CONFIG.given()
ACCURACY = accuracy_of(CONFIG)
SCENES, SIMULATIONS = config.get("scenes", {}), all_simulations(CONFIG)
# Parameters of the layers of scenes in SI units.
LAYERS = {name: scene.layer_parameters() for name, scene in CONFIG.scenes.items()}
TITLES = {name: scene["title"] for name, scene in SCENES.items()}
OWN_SIMULATIONS = [name for name in CONFIG.simulations if name not in SHIPPED["simulations"]]


def environment(wildcards):
    """Folder that all jobs depend on, since Snakemake goes by the content of files, not their time.

    It asks for the folder when it has read its options.
    """
    if workflow.dag_settings is None:
        return []
    if workflow.is_main_process:
        begin()
    return [SOURCES]


def run_step(rule, wildcards, input, output, params, threads, log):
    """Run the step of a rule in another process, which need not load Snakemake."""
    settings = dict(wildcards.items()) | dict(params.items()) | {"threads": threads}
    origin, name = PLAN.origins[below(output[0])], " ".join([rule, *wildcards])
    files, outputs = (
        {key: str(file) if isinstance(file, str) else [*file] for key, file in named.items()}
        for named in (input, output)
    )
    try:
        JOBS.run(origin, name, files, outputs, settings, str(log))
    except JobFailed as reason:
        # Snakemake reads the log of a failed job, which a process that never began has not written.
        with suppress(OSError):
            Path(str(log)).touch()
        FAILED.append(str(reason))
        raise


FIGURES = [name for name in NEEDS if name.startswith("fig")]
TOPICS = declared("steps.predict", "TOPICS")
SWEEPS = {f"sweep_{name}": {"measured": {name: TOPICS}} for name in OWN_SIMULATIONS}
CLAIM_SIMULATIONS = declared("claims.paper", "SIMULATIONS")
CLAIM_PREDICTED = {name: topics for name, topics in CLAIM_SIMULATIONS.items() if topics}
# The front speeds are those of one level, without a grid study.
CLAIM_PREDICTED["front_speed"] = ["front"]
REPORT_NEEDS = declared("steps.write_report", "NEEDS")
READ = [CLAIM_PREDICTED, *(needs.get("measured", {}) for needs in (REPORT_NEEDS, *NEEDS.values()))]
# Paths by kind of file, for a name; a list is named by its path.
FILES = {
    "data": "results/data/{name}.nc",
    "measured": "results/measurements/{name}.csv",
    "predicted": "results/predictions/{name}.csv",
    "uncertainties": "results/uncertainties/{name}.csv",
    "coarser": "results/uncertainties/coarser/{name}.csv",
    "studies": "results/studies/{name}.csv",
    "lists": "{name}",
    "figures": expand("results/figures/{{name}}.{ending}", ending=("pdf", "png", "csv")),
    "scenes": expand("results/scenes/{{name}}.{ending}", ending=("html", "png", "pdf", "csv")),
    "animations": "results/scenes/{name}.gif",
    "kernels": "results/kernels/{name}.txt",
}
# A job whose modules reach these kernels waits until they are compiled.
KERNELS = {
    "layer": "src/slippulse/solver/layer.py",
    "localised": "src/slippulse/solver/taylor.py",
    "fixed_step": "src/slippulse/solver/fixed_step.py",
}


def made(kind, names):
    """Files of one kind."""
    return expand(FILES[kind], name=[*names])


# Changes by an overlay or the command line; None where nothing can have changed.
ALTERED = Alterations(read_config(SHIPPED, every_run=False), CONFIG) if OVERLAYS or said else None


def note_of(needs, *keys):
    """One line on what differs from the shipped configuration in what a figure is made from."""
    if ALTERED is None:
        return ""
    names, settings = set(), [*keys, *needs.get("settings", ())]
    for needed in (needs, *(STUDY_NEEDS[study] for study in needs.get("studies", ()))):
        settings += needed.get("settings", ())
        for kind in ("data", "measured", "uncertainties", "sweeps"):
            names.update(needed.get(kind, ()))
    return ALTERED.note(sorted(names), settings)


def inputs_of(needs):
    """Files that a figure or a study is made from, by kind; predictions of the topics it names."""
    predicted = [name for name, topics in needs.get("measured", {}).items() if topics]
    needs = {**needs, "predicted": predicted}
    return {kind: made(kind, names) for kind, names in needs.items() if kind in FILES}


# Snakemake asks for the params of all waiting jobs whenever a job has ended.
@cache
def settings_of(job):
    """Settings of the jobs on a simulation, or on a chunk of it, such as NAME/3-of-8."""
    name, _, chunk = job.partition("/")
    simulation = SIMULATIONS[name]
    whole = resolve(simulation, CONFIG.model, ACCURACY)
    sweep = whole | ({"chunk": [int(number) for number in chunk.split("-of-")]} if chunk else {})
    scheme = sweep["scheme"]
    # The bound is computed where a rule asks for it, since jobs on other nodes check no scenes.
    bound = cache(lambda: bound_of_sweep(whole, simulation.chunks))
    # A fraction of the way to the arrest counts under a stress boundary only.
    share = config["measure"]["share"] if sweep["boundary"] == "stress" else None
    factors = map(float, ACCURACY["coarser"])
    return {
        # Where an accuracy is asked for, the sweep has the spacing of each run.
        "sweep": promised(sweep),
        "sweeps": {factor: promised(sweep | {"coarser": factor}) for factor in factors},
        "measure": {**config["measure"], "share": share},
        # A shipped simulation has the topics that are read; an added one has all.
        "topics": sorted(set().union(*(read.get(name, ()) for read in READ)) or TOPICS),
        "solver": declared("steps.simulate", "SOLVERS")[scheme],
        "kernels": made("kernels", {scheme} & {*KERNELS}),
        "bound": bound,
        "exceeded": lambda: bound().exceeded(simulation.chunks),
        "runs": run_count(whole),
    }


# Chunks of the sweeps that are divided. The name has their number: files of another are not taken.
CHUNKS = {
    name: [f"{name}/{number}-of-{sweep.chunks}" for number in range(1, sweep.chunks + 1)]
    for name, sweep in SIMULATIONS.items()
    if sweep.chunks > 1
}
# Kind and simulation of each joined file, below results/.
KINDS = ("data", "measured", "predicted", "uncertainties", "coarser")
JOINED = {below(*made(kind, [name])): (kind, name) for name in CHUNKS for kind in KINDS}
# Values of the wildcards. The simulation of one job is one without chunks, or a chunk of another.
ONE_JOB = [job for name in SIMULATIONS for job in CHUNKS.get(name, [name])]
VALUES = {"simulation": ONE_JOB, "joined": [*JOINED], "scene": [*SCENES], "scheme": [*KERNELS]}


wildcard_constraints:
    **{name: "|".join(map(re.escape, values)) or "(?!)" for name, values in VALUES.items()},


def setting(key):
    """A setting of the simulation of a rule, as a function of its wildcards."""
    return lambda wildcards: settings_of(wildcards.simulation)[key]


def joined(function):
    """A function of the kind and simulation of a joined file, as one of its wildcards."""
    return lambda wildcards: function(*JOINED[wildcards.joined])
