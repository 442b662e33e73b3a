"""Draw one scene and write its page."""

from slippulse.steps.jobs import draw_scene, job

with job(snakemake.log[0]):
    draw_scene(
        snakemake.wildcards.scene,
        snakemake.params.scene["title"],
        snakemake.input.data,
        snakemake.input.study,
        snakemake.params.scene["share"],
        {key: snakemake.output[key] for key in ("numbers", "csv", "png", "pdf", "html")},
    )
