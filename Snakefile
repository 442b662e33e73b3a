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
        EVERYTHING if WHOLE else FIRST,
    message:
        "Done: open results/index.html" if WHOLE else "Done: open results/figures; everything adds the rest"


rule everything:
    input:
        EVERYTHING,
    message:
        "Done: open results/index.html"


include: "workflow/rules/targets.smk"


onsuccess:
    end()


onerror:
    end()
