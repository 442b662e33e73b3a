# The whole paper from one configuration: simulate, measure, draw.
#   snakemake --cores 2                                        everything
#   snakemake --cores 2 results/figures/fig05_scaling.png      one figure and its inputs
#   snakemake --cores 2 --configfile mine.yaml                 with an overlaid configuration


include: "workflow/rules/common.smk"
include: "workflow/rules/simulate.smk"
include: "workflow/rules/figures.smk"
include: "workflow/rules/pages.smk"


rule all:
    default_target: True
    input:
        # All files that they are made from are targets too: a missing one is made again.
        lambda wildcards: [f"results/{name}" for name in PLAN.wanted(["all"])],


rule verify:
    input:
        environment,


include: "workflow/rules/targets.smk"


onsuccess:
    end()


onerror:
    sys.stderr.write("".join(f"{reason}\n" for reason in FAILED))
