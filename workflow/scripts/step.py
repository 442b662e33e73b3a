"""Run the step of a rule: what Snakemake has for it, as plain values."""

from slippulse.steps.job import run_job

settings = dict(snakemake.params.items()) | {"threads": snakemake.threads}
run_job(
    settings.pop("step"),
    " ".join([snakemake.rule, *snakemake.wildcards]),
    dict(snakemake.input.items()),
    dict(snakemake.output.items()),
    settings,
    snakemake.log[0],
)
