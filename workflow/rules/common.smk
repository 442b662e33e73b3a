# What the rules share: the checked configuration, and what each result comes from.

import os
import re
import sys
from functools import cache
from pathlib import Path

from slippulse.configuration.accuracy import promised
from slippulse.configuration.expand import run_count
from slippulse.configuration.read import read_config, read_overlay
from slippulse.configuration.resolve import accuracy_of, all_simulations, bound_of_sweep, resolve
from slippulse.data.alterations import changes
from slippulse.model.checks import ConfigError
from slippulse.steps.job import Jobs, end_with
from slippulse.steps.reach import below, declared, needs_of, sources
from slippulse.steps.targets import selected


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


def run_step(rule, wildcards, input, output, params, threads):
    """Run the step of a rule on plain values, in a process of its own."""
    settings = dict(wildcards.items()) | dict(params.items()) | {"threads": threads}
    name, log = (sign.join([rule, *wildcards]) for sign in " /")
    files = (dict(input.items()), dict(output.items()))
    JOBS.run(ORIGINS[below(output[0])], name, *files, settings, f"results/logs/{log}.log")


# Each figure and study by name; what it is made from stands in its module: simulations by kind of file, studies, and
# dotted keys of the configuration.
NEEDS, STUDY_NEEDS = needs_of("figures"), needs_of("studies")
FIGURES = [name for name in NEEDS if name.startswith("fig")]
if unknown := {*(CONFIG.studies or ())} - {*STUDY_NEEDS}:
    refuse(f"studies: {', '.join(sorted(unknown))}; allowed: {', '.join(STUDY_NEEDS)}")
TOPICS = declared("steps.predict", "TOPICS")
SWEEP_NEEDS = {f"sweep_{name}": {"measured": [name], "predicted": {name: TOPICS}} for name in OWN_SIMULATIONS}
# What is read of predictions: topics by simulation.
CLAIM_PREDICTED, REPORT_NEEDS = declared("claims.paper", "PREDICTED"), declared("steps.write_report", "NEEDS")
READ = [CLAIM_PREDICTED, *(needs.get("predicted", {}) for needs in (REPORT_NEEDS, *NEEDS.values()))]
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
OF_SIMULATIONS = [kind for kind in NEEDED if kind not in ("studies", "lists")]
# Sweeps that several jobs share. How many is in the name of each chunk: files left by another number are never taken.
CHUNKS = {
    name: [f"{name}/{number}-of-{sweep.chunks}" for number in range(1, sweep.chunks + 1)]
    for name, sweep in SIMULATIONS.items()
    if sweep.chunks > 1
}
# What each wildcard stands for.
VALUES = {
    # What one job works at: a simulation without chunks, or one chunk of another, as NAME/3-of-8.
    "simulation": [job for name in SIMULATIONS for job in CHUNKS.get(name, [name])],
    # What is made of each simulation, by chunks or not.
    "joined": [below(NEEDED[kind].format(name)) for name in CHUNKS for kind in OF_SIMULATIONS],
    "scene": [*SCENES],
}


wildcard_constraints:
    **{name: "|".join(map(re.escape, values)) or "(?!)" for name, values in VALUES.items()},


# Snakemake asks for the parameters of every waiting job again whenever a job has ended: they are found once.
@cache
def sweep_of(job, coarser=1.0):
    """All that the data of a simulation, or of a chunk of it (NAME/3-of-8), depend on."""
    name, _, chunk = job.partition("/")
    found = resolve(SIMULATIONS[name], CONFIG.model, ACCURACY, coarser)
    return found | ({"chunk": [int(number) for number in chunk.split("-of-")]} if chunk else {})


@cache
def promised_sweep(job, coarser=1.0):
    """The same, with the spacing of each run where an accuracy is asked for."""
    return promised(sweep_of(job, coarser))


@cache
def bound_of_job(job):
    """What a job that simulates takes at most."""
    name = job.partition("/")[0]
    return bound_of_sweep(sweep_of(name), SIMULATIONS[name].chunks)


def measure_of(job):
    """How it is measured: a share of the way to the arrest counts under a stress boundary only."""
    stressed = sweep_of(job)["boundary"] == "stress"
    return config["measure"] if stressed else {**config["measure"], "share": None}


def step_for(step, job):
    """A step that runs scenes, by their scheme: an edit of the theory re-runs exact solutions alone."""
    return step if kernels_for(job) else f"{step}_exact"


def kernels_for(job):
    """Only runs on lattices wait for the kernels."""
    return [] if sweep_of(job)["scheme"] == "continuum" else ["results/kernels.txt"]


@cache
def topics_of(simulation):
    """What is predicted of it: as far as it is read; all of what an overlay adds."""
    return sorted({topic for read in READ for topic in read.get(simulation, ())} or TOPICS)


def joined_path(wildcards):
    """What is put together from chunks, below results/."""
    return Path(wildcards.joined)


def kernels_of(study):
    """Only a study that reaches the solver waits for the kernels."""
    reached = any("solver" in Path(path).parts for path in sources(f"studies.{study}"))
    return ["results/kernels.txt"] * reached


def figure_files(names):
    """PDF, PNG and CSV of each figure."""
    return [f"results/figures/{name}.{ending}" for name in names for ending in ("pdf", "png", "csv")]


def scene_files(names):
    """What is made of each scene."""
    return [f"results/scenes/{name}.{ending}" for name in names for ending in ("html", "png", "pdf", "csv")]


def made(kind, names):
    """Files of one kind of need."""
    return [NEEDED[kind].format(name) for name in names]


def inputs_of(needs):
    """Files that a figure or a study is made from, by kind."""
    return {kind: made(kind, needs.get(kind, [])) for kind in NEEDED}


def simulations_of(*needs):
    """Simulations that some figures or studies are made from, through other studies too."""
    found = set()
    for one in needs:
        found.update(*(one.get(kind, []) for kind in (*OF_SIMULATIONS, "sweeps")))
        found.update(simulations_of(*(STUDY_NEEDS[study] for study in one.get("studies", []))))
    return sorted(found)
