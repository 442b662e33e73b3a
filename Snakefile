# The whole paper from one configuration: simulate, measure, draw.
#   snakemake --cores 2                                        everything
#   snakemake --cores 2 results/figures/fig05_scaling.png      one figure and only what it needs
#   snakemake --cores 2 --config preset=draft                  the figures of the paper, coarse and quick
#   snakemake --cores 2 --config preset=draft -- everything    studies, ledger and report too
#   snakemake --cores 2 --configfile mine.yaml                 any part of the configuration overlaid


include: "workflow/rules/common.smk"
include: "workflow/rules/simulate.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/pages.smk"


rule all:
    default_target: True
    input:
        # With all that they are made from: what is missing of that is made again too.
        lambda wildcards: [f"results/{name}" for name in PLAN.wanted(["all"])],


include: "workflow/rules/targets.smk"


onsuccess:
    end()


onerror:
    end()
