"""Numerical uncertainty of every number of one simulation block."""

from slippulse.jobs import estimate_uncertainty, logged

with logged(snakemake.log[0]):
    estimate_uncertainty(
        snakemake.input.finest, snakemake.input.coarser, snakemake.params.factors, snakemake.output[0]
    )
