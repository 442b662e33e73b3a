"""Compile every kernel into the cache that the simulations share."""

from slippulse.jobs import compile_kernels, logged

with logged(snakemake.log[0]):
    compile_kernels(snakemake.output[0])
