"""Write the list of scenes."""

from slippulse.steps.jobs import job, write_scenes_page

with job(snakemake.log[0]):
    write_scenes_page(snakemake.params.scenes, snakemake.output[0])
