"""Numerical uncertainty of every number of one simulation block, from coarser lattices."""

from slippulse.steps.jobs import job, study_grid

with job(snakemake.log[0]):
    study_grid(
        snakemake.wildcards.simulation,
        snakemake.input.finest,
        snakemake.params.blocks,
        snakemake.params.settings,
        snakemake.threads,
        snakemake.output.uncertainties,
        snakemake.output.tables,
    )
