# The workflow: it simulates, measures, draws figures, judges the claims and writes the report.
#   snakemake --cores 2                                        all results
#   snakemake --cores 2 results/figures/fig05_scaling.png      one figure and its inputs
#   snakemake --cores 2 --configfile mine.yaml                 with an overlay

from snakemake.utils import min_version

min_version("9.0")


include: "workflow/rules/common.smk"
include: "workflow/rules/simulate.smk"
include: "workflow/rules/chunks.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/pages.smk"


report: "workflow/report/workflow.rst"


rule all:
    default_target: True
    input:
        # By default, a preset that is not `whole`, such as draft, makes only figures.
        EVERYTHING if ACCURACY.get("whole", True) else DRAFT,


rule everything:
    input:
        EVERYTHING,


rule scenes:
    input:
        made("scenes", SCENES),
        made("animations", SCENES),
        "results/scenes/index.html",


onstart:
    check_packages_and_lock()
    # Without the profile of this folder, Snakemake starts a separate process for each job.
    if workflow.execution_settings.use_threads:
        WORKERS.start(workflow.cores)
        # With its limit of the rate of jobs, Snakemake considers all waiting jobs many times per
        # second. Local jobs need no limit. Without it a draft of all results takes 48 s instead of
        # 51 s, and this process 3 s of processor time instead of 7 s.
        workflow.scheduler.job_rate_limiter = None


onerror:
    print(*FAILED, sep="\n", file=sys.stderr)
