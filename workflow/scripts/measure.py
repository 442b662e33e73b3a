"""Measure every run of one simulation block."""

from slippulse.steps.jobs import job, measure_block

with job(snakemake.log[0]):
    measure_block(snakemake.input.data, snakemake.params.settings, snakemake.output[0])
