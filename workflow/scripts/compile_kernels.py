"""Compile every kernel into the cache that the simulations share."""

from slippulse.steps.jobs import compile_kernels, job

with job(snakemake.log[0]):
    compile_kernels(snakemake.output[0])
