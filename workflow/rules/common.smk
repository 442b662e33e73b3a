# What the rules share: the checked configuration, the sources that results depend on, and who draws from what.

import math
from pathlib import Path

from snakemake.exceptions import WorkflowError

from slippulse.configuration.expand import ConfigError, accuracy_of, resolve
from slippulse.configuration.expand import expand as expand_block
from slippulse.configuration.cost import expected_cost
from slippulse.configuration.limits import run_count
from slippulse.configuration.scenes import scene_simulation
from slippulse.configuration.overlay import read_overlay
from slippulse.configuration.read import read_config

try:
    OVERLAYS = [read_overlay(path) for path in workflow.overwrite_configfiles]
    SHIPPED = read_overlay(Path(workflow.basedir) / "config/config.yaml")
    # A job on another node starts Snakemake anew, with scenes that were checked here.
    read_config(config, SHIPPED, workflow.config_settings.config, every_run=workflow.is_main_process)
except ConfigError as error:
    raise WorkflowError(f"The configuration is refused:\n{error}") from None

ACCURACY = accuracy_of(config)

SOURCES = Path(workflow.basedir) / "src/slippulse"
LOCK = "requirements.lock"
# Expected seconds on one core.
LONG_SWEEP = 120.0
# What joining the grid studies of a sweep takes a run, measured over a million: 1.2 kB and 0.12 s a thousand, and as
# much again for other sweeps.
BYTES_OF_A_RUN, SECONDS_OF_A_RUN = 2.4e3, 2.4e-4
# The factor to which the estimate is right.
ESTIMATE_WITHIN = 3.0


def sources(*patterns):
    """Library files that a result depends on."""
    return [str(path.relative_to(workflow.basedir)) for path in sorted(SOURCES.rglob("*.py"))]


KERNEL_SOURCES = sources("lattice/*.py")
SIMULATION_SOURCES = KERNEL_SOURCES + sources(
    "model.py",
    "prestress.py",
    "checks.py",
    "simulation.py",
    "sweep.py",
    "chunks.py",
    "points.py",
    "versions.py",
    "theory/transition.py",
    "roots.py",
)
# A promise chooses the lattice by theory.
if "promise" in ACCURACY:
    SIMULATION_SOURCES += sources("accuracy.py", "theory/front_speed.py", "theory/pulse.py")
MEASURE_SOURCES = sources("points.py", "measure/*.py", "theory/*.py", "roots.py")

CLAIM_SOURCES = sources("claims/*.py", "theory/*.py", "roots.py", "index_page.py", "pages.py")
CLAIM_SIMULATIONS = [
    "any_prestress",
    "burridge_knopoff_speed",
    "damping_displacement",
    "damping_stress",
    "pulses_across_a_step",
    "regimes_beyond",
    "regimes_displacement",
    "regimes_stress",
    "scaling_displacement",
    "scaling_stress",
    "space_time_displacement",
    "space_time_stress",
    "speed_against_gamma",
    "steady_displacement",
    "steady_stress",
]

# Each figure: the simulations whose data it draws and those whose measured numbers it draws.
FIGURES = {
    "fig01_system_sketch": {},
    "fig02_phase_diagram": {
        "data": ["regimes_displacement", "regimes_stress", "regimes_beyond"],
        "measured": ["regimes_displacement", "regimes_stress", "regimes_beyond"],
    },
    "fig03_steady_state": {
        "data": ["steady_displacement", "steady_stress"],
        "measured": ["steady_displacement", "steady_stress"],
    },
    "fig04_space_time": {
        "data": ["space_time_displacement", "space_time_stress"],
        "measured": ["space_time_displacement", "space_time_stress"],
    },
    "fig05_scaling": {"measured": ["scaling_displacement", "scaling_stress"]},
    "fig06_burridge_knopoff": {"data": ["burridge_knopoff_displacement", "burridge_knopoff_stress"]},
    "fig07_damage_zone": {},
    "fig08_steady_state_displacement": {
        "data": ["steady_displacement"],
        "measured": ["steady_displacement"],
    },
    "fig09_steady_state_stress": {"data": ["steady_stress"], "measured": ["steady_stress"]},
    "fig10_damping_displacement": {"measured": ["damping_displacement"]},
    "fig11_damping_stress": {"measured": ["damping_stress"]},
}

# What goes beyond the paper, under the same contract.
STUDIES = {
    "study_front_speed": {"measured": ["front_speed", "front_speed_slow"]},
    "study_pulse_theory": {"measured": ["pulse_damping"]},
    "study_continuum_limit": {"measured": ["continuum_fixed_ratio", "continuum_fixed_beta"]},
    "study_exact_transition": {
        "measured": [
            "scaling_displacement",
            "scaling_stress",
            "transition_convergence",
        ]
    },
    "study_arrest": {"data": ["arrest"], "measured": ["arrest"]},
    "study_stability_of_pulses": {"data": ["pulses_across_a_step", "regimes_beyond"]},
    "study_extremes": {"studies": ["extremes"]},
    "study_stability": {"studies": ["stability"]},
    "study_accuracy_cost": {"studies": ["accuracy_cost"]},
}

# The replication report: the figures that it includes, the simulations whose numbers it quotes, what it is made of.
REPORT_FIGURES = list(FIGURES | STUDIES)
REPORT_SIMULATIONS = ["scaling_displacement", "scaling_stress", "steady_displacement"]
REPORT_SOURCES = sources("report/*.py", "theory/*.py", "prestress.py", "store.py") + [
    f"manuscript/{name}"
    for name in (
        "captions.yaml",
        "errata.yaml",
        "metadata.yaml",
        "references.bib",
        "shipped_verdicts.yaml",
        "style.css",
        "template.typ",
    )
]


def figure_files(names):
    """PDF, PNG and CSV of each figure."""
    return [f"results/figures/{name}.{ending}" for name in names for ending in ("pdf", "png", "csv")]


# Sweeps that several jobs share, and how many.
CHUNKS = {
    name: sweep["chunks"] for name, sweep in config["simulations"].items() if sweep.get("chunks", 1) > 1
}
CHUNKED = "|".join(CHUNKS) or "(?!)"
# How many there are is in the name of each chunk: files left by another number are never taken.
CHUNK_NAMES = {
    name: [f"{name}/{place}-of-{count}" for place in range(1, count + 1)] for name, count in CHUNKS.items()
}
# What one job works at: a sweep without chunks, or one chunk of another, as NAME/3-of-8.
ONE_JOB = "|".join(
    [rf"(?!(?:{CHUNKED})\b)[a-z][a-z0-9_]*", *(chunk for names in CHUNK_NAMES.values() for chunk in names)]
)


def chunks_of(pattern):
    """A function for the files of all chunks of a sweep."""
    return lambda wildcards: [pattern.format(chunk) for chunk in CHUNK_NAMES[wildcards.simulation]]


def simulation_block(wildcards, coarser=1.0):
    """Everything that the data of a simulation, or of a chunk of it, depend on, in one dict of builtins."""
    name, _, chunk = wildcards.simulation.partition("/")
    if name not in config["simulations"]:
        raise WorkflowError(f"simulation: {name!r}; allowed: {', '.join(config['simulations'])}")
    block = resolve(config["simulations"][name], config["model"], ACCURACY, coarser)
    return block | {"chunk": [int(number) for number in chunk.split("-of-")]} if chunk else block


SWEEP_COSTS = {}


def sweep_cost(wildcards):
    """What a sweep is expected to cost; expanded once, since several things of each job follow from it."""
    name = wildcards.simulation
    if name not in SWEEP_COSTS:
        SWEEP_COSTS[name] = expected_cost(*expand_block(simulation_block(wildcards)))
    return SWEEP_COSTS[name]


def sweep_threads(wildcards):
    """Both cores for a sweep of more than some seconds; two short ones side by side waste less on starting up."""
    return 2 if sweep_cost(wildcards).hours * 3600 > LONG_SWEEP else 1


def job_minutes(cost, threads, attempt):
    """Time limit of a job on a cluster: the start, and the estimate with the factor to which it is right."""
    return attempt * (10 + math.ceil(ESTIMATE_WITHIN * cost.hours * 60.0 / threads))


def job_megabytes(cost, attempt):
    """Memory limit of a job on a cluster: interpreter and libraries, and what is recorded with a copy of it."""
    return attempt * (1000 + math.ceil(2.0 * cost.bytes / 1e6))


def sweep_minutes(wildcards, threads, attempt):
    """Time limit of a sweep, and of its grid study, which is coarser."""
    return job_minutes(sweep_cost(wildcards), threads, attempt)


def sweep_megabytes(wildcards, attempt):
    """Memory limit of a sweep."""
    return job_megabytes(sweep_cost(wildcards), attempt)


def join_data_megabytes(wildcards, attempt):
    """Memory limit for the data of all chunks in one file."""
    whole = resolve(config["simulations"][wildcards.simulation], config["model"], ACCURACY)
    return job_megabytes(expected_cost(*expand_block(whole)), attempt)


def join_uncertainties_megabytes(wildcards, attempt):
    """Memory limit for the grid studies of all chunks in one table: of these it holds what names each run."""
    whole = resolve(config["simulations"][wildcards.simulation], config["model"], ACCURACY)
    return attempt * (1000 + math.ceil(BYTES_OF_A_RUN * run_count(whole) / 1e6))


def join_uncertainties_minutes(wildcards, attempt):
    """Time limit for the same."""
    whole = resolve(config["simulations"][wildcards.simulation], config["model"], ACCURACY)
    return attempt * (10 + math.ceil(ESTIMATE_WITHIN * SECONDS_OF_A_RUN * run_count(whole) / 60.0))


def coarser_blocks(wildcards):
    """The same on the coarser lattices of the preset, by factor of the spacing."""
    return {float(factor): simulation_block(wildcards, float(factor)) for factor in ACCURACY["coarser"]}


def study_settings(wildcards):
    """What a study of the solver takes from the configuration."""
    if wildcards.study not in config["studies"]:
        raise WorkflowError(f"study: {wildcards.study!r}; allowed: {', '.join(config['studies'])}")
    return {
        **config["studies"][wildcards.study],
        "front_window": config["measure"]["front_window"],
        "presets": config["presets"],
    }


def figure_settings(name):
    """What a figure takes from the configuration."""
    return {
        "measure": config["measure"],
        "paper_damping_ratio": config["model"]["damping_ratio"],
        **config["figures"].get(name, {}),
    }


# Single scenes by name, beside the paper.
SCENES = config.get("scenes", {})
SCENE_NAMES = "|".join(SCENES) or "(?!)"


def block_of_scene(wildcards, coarser=1.0):
    """Everything that the data of a scene depend on, in one dict of builtins."""
    scene = scene_simulation(SCENES[wildcards.simulation], config["model"])
    return resolve(scene, config["model"], ACCURACY, coarser)


def scene_minutes(wildcards, threads, attempt):
    """Time limit of a single scene."""
    return job_minutes(expected_cost(*expand_block(block_of_scene(wildcards))), threads, attempt)


def scene_megabytes(wildcards, attempt):
    """Memory limit of a single scene."""
    return job_megabytes(expected_cost(*expand_block(block_of_scene(wildcards))), attempt)


def coarser_blocks_of_scene(wildcards):
    """The same on the two coarser lattices of the grid study."""
    return {float(factor): block_of_scene(wildcards, float(factor)) for factor in ACCURACY["coarser"]}


def simulations_behind(file):
    """Simulations that a file under results/ is made from; all of them where it may be any."""
    name = Path(file).stem
    if file.startswith("results/studies/"):
        return set()
    if name in FIGURES | STUDIES:
        needs = (FIGURES | STUDIES)[name]
        return {*needs.get("data", []), *needs.get("measured", [])}
    return {name} if name in config["simulations"] else set(config["simulations"])


def scenes_behind(file):
    """Scenes that a file under results/scenes is made from."""
    name = Path(file).stem
    return {scene for scene in SCENES if name == scene or name.startswith(f"{scene}_")} or set(SCENES)


def blocks_behind(arguments):
    """Blocks that the command line asks for, resolved, by key."""
    files = [argument for argument in arguments if argument.startswith("results/")]
    if not files and "scenes" in arguments:
        files = ["results/scenes/index.html"]
    elif not files and not ACCURACY.get("whole", True) and "everything" not in arguments:
        files = figure_files(FIGURES)
    scenes = [file for file in files if file.startswith("results/scenes/")]
    names = {name for file in files or [""] if file not in scenes for name in simulations_behind(file)}
    blocks = {f"simulations.{name}": config["simulations"][name] for name in sorted(names)}
    for name in sorted({name for file in scenes for name in scenes_behind(file)}):
        blocks[f"scenes.{name}"] = scene_simulation(SCENES[name], config["model"])
    return {key: resolve(block, config["model"], ACCURACY) for key, block in blocks.items()}


def builtins_of(value):
    """Plain dicts and lists, whose changes Snakemake sees."""
    if isinstance(value, dict):
        return {key: builtins_of(entry) for key, entry in value.items()}
    return [builtins_of(entry) for entry in value] if isinstance(value, list) else value


def captions_of(names):
    """Path of each figure's caption."""
    return {name: str(Path(workflow.basedir) / f"workflow/report/{name}.rst") for name in names}


def captions_and_settings(names):
    """What each figure's caption is made from."""
    return {
        name: {"caption": path, "settings": builtins_of(figure_settings(name))}
        for name, path in captions_of(names).items()
    }
