"""Run one study of the solver and write its table."""

from slippulse.jobs import logged, run_study

with logged(snakemake.log[0]):
    run_study(snakemake.params.study, snakemake.params.settings, snakemake.output[0])
