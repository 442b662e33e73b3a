"""Summarise Snakemake's own benchmark files in one figure."""

from slippulse.steps.jobs import draw_pipeline_time, job

with job(snakemake.log[0]):
    draw_pipeline_time(
        "results/benchmarks", "results", {key: snakemake.output[key] for key in ("csv", "png", "pdf")}
    )
