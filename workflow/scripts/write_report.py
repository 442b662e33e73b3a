"""Execute the replication report and render it."""

from slippulse.steps.jobs import job, write_report

with job(snakemake.log[0]):
    write_report(
        dict(snakemake.input.items()),
        snakemake.params.figures,
        snakemake.params.settings,
        dict(snakemake.output.items()),
    )
