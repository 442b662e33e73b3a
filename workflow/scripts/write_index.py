"""Write the page that leads to all results."""

from slippulse.steps.jobs import job, write_index

with job(snakemake.log[0]):
    write_index(
        {key: snakemake.input[key] for key in ("captions", "summary")},
        snakemake.params.galleries,
        snakemake.params.scenes,
        snakemake.output[0],
    )
