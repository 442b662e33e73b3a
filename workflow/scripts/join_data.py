"""Put the data of a sweep's chunks into one file."""

from slippulse.steps.jobs import job, join_data

with job(snakemake.log[0]):
    join_data(snakemake.input.chunks, snakemake.params.record, snakemake.output[0])
