"""Animate one scene."""

from slippulse.steps.jobs import animate_scene, job

with job(snakemake.log[0]):
    animate_scene(snakemake.params.title, snakemake.input.data, snakemake.output[0])
