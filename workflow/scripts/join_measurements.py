"""Put the measured tables of a sweep's chunks into one."""

from slippulse.steps.jobs import job, join_measurements

with job(snakemake.log[0]):
    join_measurements(snakemake.input.chunks, snakemake.output[0])
