"""Write the page that leads to all results."""

from slippulse.steps.jobs import job, write_index

with job(snakemake.log[0]):
    write_index(
        snakemake.params.figures,
        snakemake.params.studies,
        snakemake.params.scenes,
        {key: snakemake.input[key] for key in ("claims", "provenance")},
        snakemake.output[0],
    )
