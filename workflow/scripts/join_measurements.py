"""Put the measured tables of a sweep's chunks into one."""

from slippulse.jobs import join_measurements, logged

with logged(snakemake.log[0]):
    join_measurements(snakemake.input.chunks, snakemake.output[0])
