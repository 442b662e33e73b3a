"""Write the table of one figure and draw the figure from it."""

from slippulse.steps.jobs import draw_figure, job

with job(snakemake.log[0]):
    draw_figure(
        snakemake.params.figure,
        snakemake.params.settings,
        snakemake.input.data,
        snakemake.input.measured,
        {key: snakemake.output[key] for key in ("csv", "png", "pdf")},
    )
