# What the rules share: the checked configuration, and what each result comes from.

import os
import re
import sys
from copy import deepcopy
from functools import cache
from pathlib import Path

from slippulse.configuration.accuracy import promised
from slippulse.configuration.bound import bound_of_sweep
from slippulse.configuration.expand import run_count
from slippulse.configuration.overlay import read_overlay
from slippulse.configuration.read import read_config
from slippulse.configuration.resolve import accuracy_of, all_simulations, resolve
from slippulse.data.alterations import changes
from slippulse.model.checks import ConfigError
from slippulse.steps.job import Jobs, end_with
from slippulse.steps.origins import below
from slippulse.steps.reach import PACKAGE, declared


def refuse(reason):
    """Stop before anything runs, with the reason and no more."""
    sys.stderr.write(f"{reason}\n")
    raise SystemExit(1)


try:
    OVERLAYS = [read_overlay(path) for path in workflow.overwrite_configfiles]
    SHIPPED = read_overlay(Path(workflow.basedir) / "config/config.yaml")
    # A job on another node starts Snakemake anew, with scenes that were checked here.
    CONFIG = read_config(SHIPPED, OVERLAYS, workflow.config_settings.config, workflow.is_main_process)
except ConfigError as error:
    refuse(f"The configuration is refused:\n{error}")

# Snakemake's own merge has read YAML 1.1.
config.clear()
config.update(CONFIG.given())
ACCURACY = accuracy_of(CONFIG)
SCENES = config.get("scenes", {})
# A scene is a simulation of one run that records everything.
SIMULATIONS = all_simulations(CONFIG)
# What an overlay adds is made with the rest.
OWN_SIMULATIONS = [name for name in CONFIG.simulations if name not in SHIPPED["simulations"]]
OWN_SCENES = [name for name in SCENES if name not in SHIPPED.get("scenes", {})]

JOBS = Jobs(program=["snakemake.cli"])
if workflow.is_main_process and "SLIPPULSE_LEASH" in os.environ:
    end_with(int(os.environ.pop("SLIPPULSE_LEASH")))


def run_step(rule, wildcards, input, output, params, threads, log):
    """Run the step of a rule on plain values, in a process of its own."""
    settings = dict(params.items()) | {"threads": threads}
    origin, name = ORIGINS[below(output[0])], " ".join([rule, *wildcards])
    JOBS.run(origin, name, dict(input.items()), dict(output.items()), settings, log[0])


# Each figure and study by name; what it is made from stands in its module: simulations by kind of file, studies, and
# dotted keys of the configuration.
FIGURES, STUDIES = (
    sorted(path.stem for path in (PACKAGE / "figures").glob(pattern)) for pattern in ("fig*.py", "study_*.py")
)
NEEDS = {name: declared(f"figures.{name}", "NEEDS") for name in FIGURES + STUDIES}
STUDY_NEEDS = {
    path.stem: needs
    for path in sorted((PACKAGE / "studies").glob("*.py"))
    if (needs := declared(f"studies.{path.stem}", "NEEDS")) is not None
}
if unknown := {*(CONFIG.studies or ())} - {*STUDY_NEEDS}:
    refuse(f"studies: {', '.join(sorted(unknown))}; allowed: {', '.join(sorted(STUDY_NEEDS))}")
ALL_STUDIES = sorted(STUDY_NEEDS)
CLAIM_SIMULATIONS = declared("claims.paper", "SIMULATIONS")
EXPLORER_SIMULATIONS = declared("steps.write_explorer", "SIMULATIONS")

# Sweeps that several jobs share. How many is in the name of each chunk: files left by another number are never taken.
CHUNKS = {
    name: [f"{name}/{place}-of-{sweep.chunks}" for place in range(1, sweep.chunks + 1)]
    for name, sweep in SIMULATIONS.items()
    if sweep.chunks > 1
}
# What is made of each simulation, by chunks or not.
KINDS = {
    "data": "nc",
    "measurements": "csv",
    "predictions": "csv",
    "uncertainties": "csv",
    "uncertainties/coarser": "csv",
}
# What each wildcard stands for.
VALUES = {
    # What one job works at: a simulation without chunks, or one chunk of another, as NAME/3-of-8.
    "simulation": [job for name in SIMULATIONS for job in CHUNKS.get(name, [name])],
    "joined": [f"{kind}/{name}.{ending}" for name in CHUNKS for kind, ending in KINDS.items()],
    "scene": [*SCENES],
    "sweep": [*CONFIG.simulations],
}


wildcard_constraints:
    **{name: "|".join(map(re.escape, values)) or "(?!)" for name, values in VALUES.items()},


# Snakemake asks for the parameters of every waiting job again whenever a job has ended: they are found once.
@cache
def sweep_of(name, coarser=1.0):
    """All that the data of a simulation depend on."""
    if name not in SIMULATIONS:
        refuse(f"simulation: {name!r}; allowed: {', '.join(SIMULATIONS)}")
    return resolve(SIMULATIONS[name], CONFIG.model, ACCURACY, coarser)


@cache
def sweep_of_job(job, coarser=1.0):
    """The same of a simulation or of a chunk of it, NAME/3-of-8."""
    name, _, chunk = job.partition("/")
    found = sweep_of(name, coarser)
    if chunk:
        found = found | {"chunk": [int(number) for number in chunk.split("-of-")]}
    return promised(found)


@cache
def coarser_sweeps(job):
    """The same on the coarser lattices of the preset, by factor of the spacing."""
    return {float(factor): sweep_of_job(job, float(factor)) for factor in ACCURACY["coarser"]}


def selected(keys, own={}):
    """The values of some dotted keys of the configuration, nested as there, beside what is a result's own."""
    found = deepcopy(dict(own))
    for key in keys:
        inside, value = found, config
        *parents, last = key.split(".")
        for parent in parents:
            inside, value = inside.setdefault(parent, {}), value[parent]
        inside[last] = value[last]
    return found


def measure_of(simulations):
    """How they are measured: a share of the way to the arrest counts under a stress boundary only."""
    stressed = any(sweep_of(name)["boundary"] == "stress" for name in simulations)
    return config["measure"] if stressed else {**config["measure"], "share": None}


def figure_files(names):
    """PDF, PNG and CSV of each figure."""
    return [f"results/figures/{name}.{ending}" for name in names for ending in ("pdf", "png", "csv")]


def scene_files(names):
    """What is made of each scene."""
    return [f"results/scenes/{name}.{ending}" for name in names for ending in ("html", "png", "pdf", "csv")]


# Where the files of each kind of need are.
NEEDED = {
    "data": "results/data/{}.nc",
    "measured": "results/measurements/{}.csv",
    "predicted": "results/predictions/{}.csv",
    "uncertainties": "results/uncertainties/{}.csv",
    "coarser": "results/uncertainties/coarser/{}.csv",
    "studies": "results/studies/{}.csv",
    # Lists of entries, by their whole path.
    "lists": "{}",
}


def inputs_of(needs):
    """Files that a figure or a study is made from, by kind."""
    return {kind: [path.format(name) for name in needs.get(kind, [])] for kind, path in NEEDED.items()}


def simulations_in(needs):
    """Simulations that a figure or a study is made from, through other studies too."""
    found = {name for kind in NEEDED if kind not in ("studies", "lists") for name in needs.get(kind, [])}
    found |= set(needs.get("sweeps", []))
    for study in needs.get("studies", []):
        found |= simulations_in(STUDY_NEEDS[study])
    return found


def simulations_of(names):
    """Simulations that figures are drawn from."""
    return sorted(set().union(*(simulations_in(NEEDS[name]) for name in names)))


def tables(kind, names):
    """Tables of simulations: measurements, predictions, uncertainties or uncertainties/coarser."""
    return [f"results/{kind}/{name}.csv" for name in names]


@cache
def bound_of_job(job):
    """What a job that simulates takes at most."""
    name = Path(job).parts[0]
    return bound_of_sweep(sweep_of(name), SIMULATIONS[name].chunks)


def job_threads(wildcards):
    return bound_of_job(wildcards.simulation).threads


def job_minutes(wildcards, attempt):
    return attempt * bound_of_job(wildcards.simulation).minutes


def job_megabytes(wildcards, attempt):
    return attempt * bound_of_job(wildcards.simulation).megabytes


def joining_megabytes(wildcards, attempt):
    """Measured over a million runs: 1.2 kB a run, and as much again for other sweeps."""
    return attempt * (1000 + run_count(sweep_of(Path(wildcards.joined).stem)) // 400)


def step_for(step, wildcards):
    """A step that runs scenes, by their scheme: an edit of the theory re-runs exact solutions alone."""
    return f"{step}_exact" if sweep_of(Path(wildcards.simulation).parts[0])["scheme"] == "continuum" else step


def chunks_of(joined):
    """Files of the chunks that a file is put together from, in the order of their numbers."""
    kind, ending = Path(joined).parent, Path(joined).suffix
    return [f"results/{kind}/{chunk}{ending}" for chunk in CHUNKS[Path(joined).stem]]


def studied_in(joined):
    """The measurements that a grid study is of; nothing for other files."""
    path = Path(joined)
    return tables("measurements", [path.stem]) if path.parent == Path("uncertainties") else []


def settings_of_figure(name):
    """What a figure reads of the configuration itself."""
    return selected(NEEDS[name].get("settings", ()), config["figures"].get(name, {}))


def settings_of_study(name):
    """What a study reads of the configuration; under `sweeps` the resolved simulations that it names."""
    needs = STUDY_NEEDS[name]
    found = selected(needs.get("settings", ()), {})
    sweeps = {sweep: sweep_of(sweep) for sweep in needs.get("sweeps", [])}
    return found | ({"sweeps": sweeps} if sweeps else {})
