"""Compute the ledger of claims."""

from slippulse.steps.jobs import job, write_claims

with job(snakemake.log[0]):
    write_claims(
        snakemake.input.measured,
        snakemake.input.coarser,
        snakemake.input.uncertainties,
        snakemake.params.settings["claims"],
        snakemake.params.settings["measure"]["share"],
        snakemake.params.settings["published"],
        {kind: snakemake.output[kind] for kind in ("json", "html")},
    )
