"""Put the grid studies of a sweep's chunks into one."""

from slippulse.steps.jobs import job, join_uncertainties

with job(snakemake.log[0]):
    join_uncertainties(
        snakemake.input.finest,
        snakemake.input.uncertainties,
        snakemake.input.tables,
        {key: snakemake.output[key] for key in ("uncertainties", "tables")},
    )
