"""Run one study of the solver and write its table."""

from slippulse.steps.jobs import job, run_study

with job(snakemake.log[0]):
    run_study(snakemake.params.study, snakemake.params.settings, snakemake.output[0])
