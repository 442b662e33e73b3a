# What the rules share: the checked configuration, and what each result comes from.

import sys
from functools import cache
from pathlib import Path

from slippulse.configuration.expand import ConfigError, accuracy_of, resolve
from slippulse.configuration.job_limits import joining_limits, sweep_limits
from slippulse.configuration.limits import run_count
from slippulse.configuration.overlay import read_overlay
from slippulse.configuration.read import read_config
from slippulse.configuration.scenes import all_simulations
from slippulse.data.alterations import changes
from slippulse.data.records import digest_of
from slippulse.steps.job import Jobs
from slippulse.steps.reach import PACKAGE, declared, sources


def refuse(reason):
    """Stop before anything runs, with the reason and no more."""
    sys.stderr.write(f"{reason}\n")
    raise SystemExit(1)


try:
    OVERLAYS = [read_overlay(path) for path in workflow.overwrite_configfiles]
    SHIPPED = read_overlay(Path(workflow.basedir) / "config/config.yaml")
    # A job on another node starts Snakemake anew, with scenes that were checked here.
    read_config(config, SHIPPED, workflow.config_settings.config, every_run=workflow.is_main_process)
except ConfigError as error:
    refuse(f"The configuration is refused:\n{error}")

ACCURACY = accuracy_of(config)
LOCK = "requirements.lock"
SCENES = config.get("scenes", {})
# A scene is a simulation of one run that records everything.
SIMULATIONS = all_simulations(config)
# What an overlay adds is made with the rest.
OWN_SIMULATIONS = [name for name in config["simulations"] if name not in SHIPPED["simulations"]]
OWN_SCENES = [name for name in SCENES if name not in SHIPPED.get("scenes", {})]

JOBS = Jobs(program=["snakemake.cli"])


def run_step(rule, wildcards, input, output, params, threads, log):
    """Run the step of a rule on plain values, in a process of its own."""
    settings = dict(params.items()) | {"threads": threads}
    name = " ".join([rule, *wildcards])
    JOBS.run(settings.pop("step"), name, dict(input.items()), dict(output.items()), settings, log[0])


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
ALL_STUDIES = sorted(STUDY_NEEDS)
CLAIM_SIMULATIONS = declared("claims.paper", "SIMULATIONS")
EXPLORER_SIMULATIONS = declared("steps.write_explorer", "SIMULATIONS")

# Sweeps that several jobs share. How many is in the name of each chunk: files left by another number are never taken.
CHUNKS = {
    name: [f"{name}/{place}-of-{sweep['chunks']}" for place in range(1, sweep["chunks"] + 1)]
    for name, sweep in SIMULATIONS.items()
    if sweep.get("chunks", 1) > 1
}
CHUNKED = "|".join(CHUNKS) or "(?!)"
# What one job works at: a simulation without chunks, or one chunk of another, as NAME/3-of-8.
ONE_JOB = "|".join(
    [rf"(?!(?:{CHUNKED})\b)[a-z][a-z0-9_]*", *(chunk for names in CHUNKS.values() for chunk in names)]
)


def plain(value):
    """Plain dicts and lists, whose changes Snakemake sees."""
    if isinstance(value, dict):
        return {key: plain(entry) for key, entry in value.items()}
    return [plain(entry) for entry in value] if isinstance(value, list) else value


# Snakemake asks for the parameters of every waiting job again whenever a job has ended: they are found once.
@cache
def sweep_of(name, coarser=1.0):
    """All that the data of a simulation depend on."""
    if name not in SIMULATIONS:
        refuse(f"simulation: {name!r}; allowed: {', '.join(SIMULATIONS)}")
    return resolve(SIMULATIONS[name], config["model"], ACCURACY, coarser)


@cache
def sweep_of_job(job, coarser=1.0):
    """The same of a simulation or of a chunk of it, NAME/3-of-8."""
    name, _, chunk = job.partition("/")
    found = sweep_of(name, coarser)
    return found | {"chunk": [int(number) for number in chunk.split("-of-")]} if chunk else found


@cache
def coarser_sweeps(job):
    """The same on the coarser lattices of the preset, by factor of the spacing."""
    return {float(factor): sweep_of_job(job, float(factor)) for factor in ACCURACY["coarser"]}


def selected(keys, own={}):
    """The values of some dotted keys of the configuration, nested as there, beside what is a result's own."""
    found = plain(own)
    for key in keys:
        inside, value = found, config
        *parents, last = key.split(".")
        for parent in parents:
            inside, value = inside.setdefault(parent, {}), value[parent]
        inside[last] = plain(value[last])
    return found


def configuration(simulations=(), **settings):
    """Digest of the part of the configuration that a result comes from."""
    return digest_of([{name: sweep_of(name) for name in sorted(set(simulations))}, settings])


@cache
def configuration_of_data(job):
    """The same for the data of one simulation, chunks or not."""
    return configuration([Path(job).parts[0]])


@cache
def configuration_of_numbers(job):
    """The same for what is measured in the data of one simulation."""
    name = Path(job).parts[0]
    return configuration([name], measure=measure_of([name]))


def measure_of(simulations):
    """How they are measured: a share of the way to the arrest counts under a stress boundary only."""
    stressed = any(sweep_of(name)["boundary"] == "stress" for name in simulations)
    return plain(config["measure"] if stressed else {**config["measure"], "share": None})


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
}


def inputs_of(needs):
    """Files that a figure or a study is made from, by kind."""
    return {kind: [path.format(name) for name in needs.get(kind, [])] for kind, path in NEEDED.items()}


def simulations_in(needs):
    """Simulations that a figure or a study is made from, through other studies too."""
    found = {name for kind in NEEDED if kind != "studies" for name in needs.get(kind, [])}
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
def limits_of(job):
    """Limits of a job that simulates, found once, since several things of it follow from them."""
    return sweep_limits(sweep_of_job(job))


def job_threads(wildcards):
    """Threads of a simulation: both cores for a long one; two short ones side by side waste less on starting."""
    return limits_of(wildcards.simulation).threads


def job_minutes(wildcards, attempt):
    """Time limit of a simulation, and of its grid study, which is coarser."""
    return attempt * limits_of(wildcards.simulation).minutes


def job_megabytes(wildcards, attempt):
    """Memory limit of a simulation."""
    return attempt * limits_of(wildcards.simulation).megabytes


def joining(wildcards):
    """Limits for joining the chunks of a simulation."""
    return joining_limits(run_count(sweep_of(wildcards.simulation)))


def settings_of_figure(name):
    """What a figure reads of the configuration itself."""
    return selected(NEEDS[name].get("settings", ()), config["figures"].get(name, {}))


def settings_of_study(name):
    """What a study reads of the configuration; under `sweeps` the resolved simulations that it names."""
    needs = STUDY_NEEDS[name]
    found = selected(needs.get("settings", ()), {})
    sweeps = {sweep: sweep_of(sweep) for sweep in needs.get("sweeps", [])}
    return found | ({"sweeps": sweeps} if sweeps else {})


def configuration_of(needs, values):
    """Digest of all that a figure or a study comes from."""
    studies = {study: settings_of_study(study) for study in needs.get("studies", [])}
    names = sorted(simulations_in(needs))
    return configuration(names, values=values, studies=studies, measure=measure_of(names) if names else {})


def configuration_of_figure(name):
    return configuration_of(NEEDS[name], settings_of_figure(name))


def configuration_of_study(name):
    return configuration_of(STUDY_NEEDS[name], settings_of_study(name))
