"""Run the scenes of one simulation block."""

from slippulse.steps.jobs import job, simulate_block

with job(snakemake.log[0]):
    simulate_block(
        snakemake.wildcards.simulation, snakemake.params.block, snakemake.threads, snakemake.output[0]
    )
