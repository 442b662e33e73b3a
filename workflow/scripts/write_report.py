"""Execute the replication report and render it."""

from slippulse.jobs import logged, write_report

with logged(snakemake.log[0]):
    write_report(
        dict(snakemake.input.items()),
        snakemake.params.figures,
        snakemake.params.settings,
        dict(snakemake.output.items()),
    )
