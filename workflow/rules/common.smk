# The checked configuration, and functions of all rules for paths, settings and source digests.

import os
import re
import sys
from contextlib import suppress
from functools import cache
from pathlib import Path

PROJECT = Path(str(workflow.current_basedir)).resolve().parents[1]
# This process and its workers run the code of this project, even if another version is installed or
# on PYTHONPATH.
SOURCE_FOLDER = str(PROJECT / "src")
sys.path.insert(0, SOURCE_FOLDER)
PYTHON_PATH = os.pathsep.join(filter(None, [SOURCE_FOLDER, os.getenv("PYTHONPATH")]))
os.environ.update(PYTHONPATH=PYTHON_PATH)

from slippulse_paper.claims.claim_texts import read_entries
from slippulse_paper.configuration.altered import Alterations
from slippulse_paper.configuration.drawn import drawing_problems
from slippulse_paper.configuration.limits import bound_of_sweep, cost_problems
from slippulse_paper.configuration.problems import ConfigError
from slippulse_paper.configuration.promised_spacings import with_promised_spacings
from slippulse_paper.configuration.read import read_config, read_overlay
from slippulse_paper.configuration.renamed_keys import rename_warnings
from slippulse_paper.configuration.resolve import accuracy_of, all_simulations, resolve
from slippulse_paper.configuration.runs import run_count
from slippulse_paper.configuration.selected import selected
from slippulse_paper.records.job_records import RecordedFiles
from slippulse_paper.records.lock import take
from slippulse_paper.records.packages import package_problem
from slippulse_paper.records.sources import modules_reached, sources_of
from slippulse_paper.steps.job import Job, JobFailed
from slippulse_paper.steps.needs import declared, needs_of
from slippulse_paper.steps.worker_pool import WorkerPool, run_here

# As a module of another workflow, this one takes its configuration from `config`, and the other
# workflow may add a prefix to the paths.
IS_MODULE = not workflow.modifier.is_main_snakefile()
WORKERS = WorkerPool()
# Lines on jobs that have failed, and the lock of this folder, which is held until the run ends.
FAILED, HELD_LOCKS = [], []


def project(path):
    """Return the path of a file of the project as seen from the working directory.

    ``path`` is relative to the project.
    """
    is_in_project = Path.cwd() == PROJECT and not IS_MODULE
    return path if is_in_project else f"{PROJECT}/{path}"


try:
    # Snakemake's `configfile:` reads YAML 1.1, and its errors do not name the line.
    SHIPPED = read_overlay(PROJECT / "config/config.yaml")
    OVERLAYS = [] if IS_MODULE else [*map(read_overlay, workflow.overwrite_configfiles)]
    GIVEN = dict(config if IS_MODULE else workflow.config_settings.config)
    if not IS_MODULE:
        # Snakemake reads a name of a preset such as 01 as a number. Take the text instead.
        for argument in workflow.config_settings.config_args or ():
            name, _, text = argument.partition("=")
            if name == "preset" and text:
                GIVEN["preset"] = text
    # Only the main process checks the scenes of all runs. On a cluster, each job starts Snakemake
    # again.
    CONFIG = read_config(SHIPPED, OVERLAYS, GIVEN, workflow.is_main_process)
    # Differences from the shipped configuration, or None if there is no overlay.
    ALTERED = None
    if OVERLAYS or GIVEN:
        ALTERED = Alterations(read_config(SHIPPED, every_run=False), CONFIG)
    if ALTERED and workflow.is_main_process:
        problems = [] if CONFIG.allow_large else cost_problems(CONFIG, ALTERED)
        if not problems:
            figures = needs_of("figures")
            draws = {name: declared(f"figures.{name}", "DRAWS") or {} for name in figures}
            problems = drawing_problems(CONFIG, draws)
        if problems:
            raise ConfigError("\n".join(problems))
    if CONFIG.claims:
        read_entries(PROJECT / "manuscript/claims.yaml", CONFIG.given()["claims"])
    STUDY_NEEDS = needs_of("studies")
    if unknown := sorted({*(CONFIG.studies or ())} - {*STUDY_NEEDS}):
        raise ConfigError(f"studies: {', '.join(unknown)}; allowed: {', '.join(STUDY_NEEDS)}")
except ValueError as error:
    sys.exit(f"The configuration is refused:\n{error}")

if workflow.is_main_process:
    for line in rename_warnings([*OVERLAYS, GIVEN]):
        print(line, file=sys.stderr)

if Path("results").is_file():
    sys.exit("results is a file; remove or rename it: a folder of that name is needed")

config = CONFIG.given()
ACCURACY = accuracy_of(CONFIG)
SCENES, SIMULATIONS = config.get("scenes", {}), all_simulations(CONFIG)
# The parameters of the layer of each scene in SI units, or None.
LAYERS = {name: scene.layer_parameters() for name, scene in CONFIG.scenes.items()}
TITLES = {name: scene["title"] for name, scene in SCENES.items()}
OWN_SIMULATIONS = [name for name in CONFIG.simulations if name not in SHIPPED["simulations"]]
# The constant NEEDS of each figure: the names of its inputs for each kind of file, and the keys of
# the configuration that it reads (`settings`).
NEEDS = needs_of("figures")
FIGURES = [name for name in NEEDS if name.startswith("fig")]
TOPICS = declared("steps.predict", "TOPICS")
# The same for the figures of simulations that the user has added.
SWEEPS = {f"sweep_{name}": {"measured": {name: TOPICS}} for name in OWN_SIMULATIONS}
CLAIM_SIMULATIONS = declared("claims.paper_claims", "SIMULATIONS")
CLAIM_PREDICTED = {name: topics for name, topics in CLAIM_SIMULATIONS.items() if topics}
# Claims use the predicted front speeds of this simulation, which has no grid study.
CLAIM_PREDICTED["front_speed"] = ["front"]
REPORT_NEEDS = declared("steps.write_report", "NEEDS")
# The topics of the predictions that the claims, the report and each figure read, by simulation.
READ_TOPICS = [CLAIM_PREDICTED, REPORT_NEEDS["measured"]]
READ_TOPICS += [needs.get("measured", {}) for needs in NEEDS.values()]
# Paths of the files of each kind. {name} stands for the name of a simulation, study, figure, scene
# or scheme.
FILES = {
    "data": "results/data/{name}.nc",
    "measured": "results/measurements/{name}.csv",
    "predicted": "results/predictions/{name}.csv",
    "uncertainties": "results/uncertainties/{name}.csv",
    "coarser": "results/uncertainties/coarser/{name}.csv",
    "studies": "results/studies/{name}.csv",
    "figures": expand("results/figures/{{name}}.{ending}", ending=("pdf", "png", "csv")),
    "scenes": expand("results/scenes/{{name}}.{ending}", ending=("html", "png", "pdf", "csv")),
    "animations": "results/scenes/{name}.gif",
    "kernels": "results/kernels/{name}.txt",
}
# Table and figure of errors as a function of the computing time.
SECONDS = {ending: f"results/seconds/accuracy_cost.{ending}" for ending in ("csv", "png", "pdf")}
# Modules of the kernels, by name. A job that imports such a module, directly or not, waits until
# its kernels are compiled.
KERNELS = {
    "layer": "slippulse.solver.layer",
    "localised": "slippulse.solver.taylor",
    "fixed_step": "slippulse.solver.fixed_step",
}


def made(kind, names):
    """Return the paths of the files of one kind with some names."""
    return expand(FILES[kind], name=[*names])


def inputs_of(needs):
    """Return the input files of a figure or a study, by kind, from its NEEDS.

    Predictions are among them for each simulation that has topics in its NEEDS.
    """
    files = {kind: made(kind, names) for kind, names in needs.items() if kind in FILES}
    predicted = [name for name, topics in needs.get("measured", {}).items() if topics]
    files["predicted"] = made("predicted", predicted)
    lists = needs.get("lists", ())
    # The files of the kind `lists` are results, or texts of the project.
    files["lists"] = [path if path.startswith("results/") else project(path) for path in lists]
    return files


SOURCES_BY_DIGEST = {}


def code_of(step, *modules, texts=()):
    """Return the digest of the sources of a step. A job runs again if its digest changes.

    The sources are the module of the step, further ``modules`` that it imports by their names when
    it runs, all modules that these import, and the ``texts`` that the step reads.
    """
    step_module = f"slippulse_paper.steps.{step}"
    sources = sources_of((step_module, *modules), tuple(texts))
    SOURCES_BY_DIGEST[sources.digest] = sources.files
    return sources.digest


def templates(*names):
    """Return the paths of some templates, and of the two templates that all pages use."""
    folder = PROJECT / "src/slippulse_paper/report/templates"
    paths = []
    for name in ("base.html", "style.css", *names):
        paths += folder.glob(name)
    return [path.relative_to(PROJECT).as_posix() for path in paths]


def plain_paths(named_files):
    """Return Snakemake's input or output as a dictionary of paths, or of lists of paths."""
    paths = {}
    for name, value in named_files.items():
        paths[name] = str(value) if isinstance(value, str) else [str(path) for path in value]
    return paths


def run_step(step, wildcards, input, output, params, threads, log):
    """Run a step in a worker process, or in this process if Snakemake has started it for the job.

    The arguments are the name of the step, and the variables that Snakemake gives to a rule.
    """
    variables = dict(wildcards.items()) | {"threads": threads}
    job = Job(
        step=step,
        name=" ".join([step, *wildcards]),
        inputs=plain_paths(input),
        outputs=plain_paths(output),
        settings=params.settings,
        variables=variables,
        log=str(log),
        code=params.code,
        sources=SOURCES_BY_DIGEST[params.code],
    )
    try:
        if workflow.is_main_process:
            WORKERS.run(job, workflow.cores)
        else:
            run_here(job)
    except JobFailed as reason:
        # Snakemake prints the log of a failed job. If no process was started, write an empty log.
        with suppress(OSError):
            Path(str(log)).touch()
        FAILED.append(f"{job.name}: {reason}")
        raise


def note_of(needs, *keys):
    """Return a line that names altered parameters of the inputs of a figure.

    The text is empty if no parameter is altered. ``needs`` is the constant NEEDS of the figure.
    ``keys`` are further keys of the configuration that the figure reads.
    """
    if ALTERED is None:
        return ""
    simulations, settings = set(), [*keys]
    # A figure also depends on everything that its studies read.
    needs_of_studies = [STUDY_NEEDS[study] for study in needs.get("studies", ())]
    for figure_or_study_needs in [needs, *needs_of_studies]:
        settings += figure_or_study_needs.get("settings", ())
        for kind in ("data", "measured", "uncertainties", "sweeps"):
            simulations.update(figure_or_study_needs.get(kind, ()))
    return ALTERED.note(sorted(simulations), settings)


@cache
def sweep_of(name):
    """Return a simulation by its name, with all values that its results depend on (resolved)."""
    return resolve(SIMULATIONS[name], CONFIG.model, ACCURACY)


@cache
def bound_of(name):
    """Return the upper bound on the cost of one chunk of a simulation, or of all its runs."""
    return bound_of_sweep(sweep_of(name), SIMULATIONS[name].chunks)


def bound_of_job(wildcards):
    """Return the upper bound on the cost of a job on a simulation or on one chunk of it."""
    name, _, _ = wildcards.simulation.partition("/")
    return bound_of(name)


# The results are cached, because Snakemake evaluates the params of all waiting jobs whenever a job
# has ended.
@cache
def settings_of(job):
    """Return the settings of the jobs on a simulation, or on a chunk such as NAME/3-of-8.

    Each rule takes from them those that its results depend on.
    """
    name, _, chunk = job.partition("/")
    whole_sweep = sweep_of(name)
    sweep = {**whole_sweep, "chunk": chunk_numbers(chunk)} if chunk else whole_sweep
    scheme = sweep["scheme"]
    # If the displacement is held, no number depends on the fraction of |x_minus|.
    fraction = config["measure"]["fraction"] if sweep["boundary"] == "stress" else None
    factors = map(float, ACCURACY["coarser"])
    return {
        # If an accuracy is required, `with_promised_spacings` adds the spacing of each run.
        "sweep": with_promised_spacings(sweep),
        "sweeps": {
            factor: with_promised_spacings(sweep | {"coarser": factor}) for factor in factors
        },
        "measure": {**config["measure"], "fraction": fraction},
        "topics": topics_of(name),
        "solver": declared("steps.simulate", "SOLVERS")[scheme],
        # The exact solutions (scheme continuum) use no kernels.
        "kernels": made("kernels", [scheme] if scheme in KERNELS else []),
    }


def chunk_numbers(chunk):
    """Return the number of a chunk and the number of all chunks from a name such as 3-of-8."""
    return [int(number) for number in chunk.split("-of-")]


def chunk_names(name, count):
    """Return the names of all chunks of a simulation or study."""
    return [f"{name}/{number}-of-{count}" for number in range(1, count + 1)]


def with_chunks(names, chunks):
    """Return names of jobs, in which each divided simulation or study is replaced by its chunks.

    ``chunks`` has the names of the chunks of each divided simulation or study.
    """
    jobs = []
    for name in names:
        jobs += chunks.get(name, [name])
    return jobs


def topics_of(name):
    """Return the topics of the predictions that are read for a simulation.

    All topics are returned if claims, report and figures read none. This concerns the simulations
    that an overlay adds.
    """
    topics = set()
    for topics_by_simulation in READ_TOPICS:
        topics.update(topics_by_simulation.get(name, ()))
    return sorted(topics or TOPICS)


def setting(key):
    """Return a function of the wildcards of a job that returns one setting of its simulation."""
    return lambda wildcards: settings_of(wildcards.simulation)[key]


def check_packages_and_lock():
    """Exit if installed packages differ from requirements.lock, or if another run uses this folder.

    Otherwise take the lock of this folder, and print which altered defaults of the model some
    simulations override.
    """
    if problem := package_problem(PROJECT / "requirements.lock"):
        sys.exit(problem)
    # The system releases the lock when this process ends, even if it is killed.
    lock = take(".snakemake/slippulse.lock")
    if lock is None:
        sys.exit("Another run is using this folder: wait for it, or stop it.")
    HELD_LOCKS.append(lock)
    for line in ALTERED.overridden_defaults() if ALTERED else ():
        print(line, file=sys.stderr)


# Number of changed results that are named.
MAX_SHOWN_RESULTS = 5


def report_changed_results():
    """Print one line if results have changed in a way that Snakemake does not notice.

    The line names some of them, and the command that makes them again.
    """
    problems = dict(RecordedFiles("results").problems())
    if not problems:
        return
    names = [*problems]
    results_are = "1 result is" if len(names) == 1 else f"{len(names)} results are"
    more = " ..." if len(names) > MAX_SHOWN_RESULTS else ""
    reason = problems[names[0]]
    example = reason if len(names) == 1 else f"{names[0]}: {reason}"
    shown = f"{', '.join(names[:MAX_SHOWN_RESULTS])}{more} ({example})"
    remedy = "To undo this, run make replicate, or snakemake --forcerun with these names"
    print(f"{results_are} changed: {shown}. {remedy}", file=sys.stderr)


if workflow.is_main_process and not IS_MODULE:
    report_changed_results()


# The names of the chunks of each divided sweep. They contain the number of chunks, so that files of
# another division are not used.
CHUNKS = {
    name: chunk_names(name, sweep.chunks) for name, sweep in SIMULATIONS.items() if sweep.chunks > 1
}
# The names of the chunks of each divided study.
STUDY_CHUNKS = {}
LAYER_CHUNKS = config["figures"]["study_layer"].get("chunks", 1)
if LAYER_CHUNKS > 1:
    STUDY_CHUNKS["layer_map"] = chunk_names("layer_map", LAYER_CHUNKS)
# A job runs an undivided simulation or study, or one chunk.
JOB_NAMES = with_chunks(SIMULATIONS, CHUNKS)
STUDY_JOB_NAMES = with_chunks(STUDY_NEEDS, STUDY_CHUNKS)


# For each file that is joined from chunks, by its path below results/: its kind of file, and the
# name of the simulation or study.
JOINED = {}
for kind in ("data", "measured", "predicted", "uncertainties", "coarser"):
    for name in CHUNKS:
        path = FILES[kind].format(name=name).removeprefix("results/")
        JOINED[path] = (kind, name)
for name in STUDY_CHUNKS:
    JOINED[f"studies/{name}.csv"] = ("studies", name)
# The NEEDS of all figures.
ALL_FIGURES = NEEDS | SWEEPS


def solver_of(wildcards):
    """Return the name of the module that solves the scenes of a simulation."""
    return settings_of(wildcards.simulation)["solver"].partition(":")[0]


def prediction_modules(wildcards):
    """Return the names of the modules that compute the predictions of a simulation."""
    modules = declared("steps.predict", "MODULES")
    topics = settings_of(wildcards.simulation)["topics"]
    return [f"slippulse.prediction.{modules[topic]}" for topic in topics]


def joined_inputs(wildcards):
    """Return the files of the chunks from which a file is joined.

    Uncertainties also need the joined measurements, from which they get the order of the runs.
    """
    kind, name = JOINED[wildcards.joined]
    chunks = STUDY_CHUNKS[name] if kind == "studies" else CHUNKS[name]
    finest = made("measured", [name] if kind == "uncertainties" else [])
    return {"chunks": made(kind, chunks), "finest": finest}


def joined_settings(wildcards):
    """Return the kind of a joined file, and the kinds of data that its runs record."""
    kind, name = JOINED[wildcards.joined]
    return {"kind": kind, "record": SIMULATIONS[name].record if name in SIMULATIONS else []}


def joined_megabytes(wildcards, input):
    """Return the memory in MB that a job needs to join the files of chunks."""
    kind, name = JOINED[wildcards.joined]
    if kind == "data":
        return 1000 + 3 * input.size_mb
    # A table of a million runs took 1.2 kB for each run. Other tables may take twice as much.
    runs = run_count(sweep_of(name)) if name in SIMULATIONS else 0
    return 1000 + runs // 400


def study_of(wildcards):
    """Return the name of the study to which a job belongs, which may be a chunk."""
    return wildcards.study.partition("/")[0]


def study_inputs(wildcards):
    """Return the input files of a study, and the files of the kernels that it runs."""
    study = study_of(wildcards)
    modules = modules_reached(f"slippulse_paper.studies.{study}")
    schemes = [scheme for scheme, kernel_module in KERNELS.items() if kernel_module in modules]
    return {**inputs_of(STUDY_NEEDS[study]), "kernels": made("kernels", schemes)}


def study_settings(wildcards):
    """Return the name of a study, and the values of the configuration that it depends on.

    They contain the resolved simulations that the study runs itself (`sweeps`).
    """
    study, _, chunk = wildcards.study.partition("/")
    needs = STUDY_NEEDS[study]
    sweeps = {name: settings_of(name)["sweep"] for name in needs.get("sweeps", ())}
    values = selected(config, needs.get("settings", ()), {"sweeps": sweeps})
    if chunk:
        values["chunk"] = chunk_numbers(chunk)
    return {"study": study, "values": values}


def texts_of(needs):
    """Return the texts of the project among the inputs of a figure or a study."""
    return [path for path in needs.get("lists", ()) if not path.startswith("results/")]


def module_of(figure):
    """Return the name of the module that draws a figure."""
    return figure if figure in NEEDS else "user_defined_sweep"


def figure_settings(wildcards):
    """Return the module of a figure, the values that it depends on, and a note on altered ones."""
    figure, needs = wildcards.figure, ALL_FIGURES[wildcards.figure]
    values = selected(config, needs.get("settings", ()), config["figures"].get(figure, {}))
    altered = note_of(needs, f"figures.{figure}")
    return {"figure": module_of(figure), "values": values, "altered": altered}


def figure_category(wildcards):
    """Return the heading of a figure in Snakemake's report."""
    return "Figures of the paper" if wildcards.figure in FIGURES else "Studies and sweeps"


@cache
def captions():
    """Return the captions of all figures."""
    from slippulse_paper.report.texts import read_captions

    return read_captions(PROJECT / "manuscript/captions.yaml")


def title_of(figure):
    """Return the title of a figure from its caption, or its name if it has no caption."""
    return captions()[figure].title if figure in captions() else figure


def one_of(names):
    """Return a regular expression for a wildcard that allows only some values.

    Without any value, the expression matches nothing.
    """
    return "|".join(map(re.escape, names)) or "(?!)"


wildcard_constraints:
    simulation=one_of(JOB_NAMES),
    scene=one_of(SCENES),
    scheme=one_of(KERNELS),
    study=one_of(STUDY_JOB_NAMES),
    figure=one_of([*NEEDS, *SWEEPS]),
    joined=one_of(JOINED),
