"""Write provenance, checksums and manifest of the results."""

from slippulse.steps.jobs import job, write_provenance

with job(snakemake.log[0]):
    write_provenance(
        snakemake.params.root,
        snakemake.params.config,
        snakemake.params.shipped,
        snakemake.input.files,
        snakemake.input.captions,
        {key: snakemake.output[key] for key in ("provenance", "checksums", "manifest")},
    )
