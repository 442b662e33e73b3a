"""Summarise Snakemake's own benchmark files in one figure."""

from slippulse.jobs import draw_pipeline_time, logged

with logged(snakemake.log[0]):
    draw_pipeline_time(
        "results/benchmarks", "results", {key: snakemake.output[key] for key in ("csv", "png", "pdf")}
    )
