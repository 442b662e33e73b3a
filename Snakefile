# The whole paper from one configuration: simulate, measure, draw.
#   snakemake --cores 2                                        everything
#   snakemake --cores 2 results/figures/fig05_scaling.png      one figure and only what it needs
#   snakemake --cores 2 --config preset=draft                  the figures of the paper, coarse and quick
#   snakemake --cores 2 --config preset=draft -- everything     studies, ledger and report too
#   snakemake --cores 2 --configfile mine.yaml                 any part of the configuration overlaid


configfile: "config/config.yaml"


# Read only under `--software-deployment-method apptainer`; otherwise jobs run in the environment of the lock.
container: "docker://python:3.12-slim"


include: "workflow/rules/common.smk"
include: "workflow/rules/simulate.smk"
include: "workflow/rules/measure.smk"
include: "workflow/rules/chunks.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/claims.smk"
include: "workflow/rules/manuscript.smk"
include: "workflow/rules/studies.smk"
include: "workflow/rules/scenes.smk"
include: "workflow/rules/provenance.smk"


# What goes beyond the figures of the paper.
LEDGER = ["results/claims.html", "results/claims.json"]
BEYOND = [
    *figure_files(STUDIES),
    "results/studies/requirements.csv",
    "results/figures/study_pipeline_time.png",
    "results/manuscript/replication.html",
    "results/manuscript/replication.pdf",
    "results/provenance.json",
    "results/index.html",
]


rule all:
    default_target: True
    input:
        # First, so that the claims come first in Snakemake's own report too.
        LEDGER if ACCURACY.get("whole", True) else [],
        figure_files(FIGURES),
        BEYOND if ACCURACY.get("whole", True) else [],
    message:
        "Done: {}".format(
            "open results/index.html; the figures are in results/figures, the report in results/manuscript"
            if ACCURACY.get("whole", True)
            else "the figures are in results/figures; TARGET=everything adds studies, ledger and report"
        )


rule everything:
    input:
        LEDGER,
        figure_files(FIGURES),
        BEYOND,
    message:
        "Done: open results/index.html; the figures are in results/figures, the report in results/manuscript"


onstart:
    # Else Snakemake looks once more a second, for every job that has ended, whether a hundred were started in that
    # second: a tenth of the whole run.
    if workflow.local_exec:
        workflow.scheduler.job_rate_limiter = None


include: "workflow/rules/targets.smk"
