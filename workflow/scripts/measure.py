"""Measure every run of one simulation block."""

from slippulse.jobs import logged, measure_block

with logged(snakemake.log[0]):
    measure_block(snakemake.input.data, snakemake.params.settings, snakemake.output[0])
