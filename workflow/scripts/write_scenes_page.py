"""Write the list of scenes."""

from slippulse.jobs import logged, write_scenes_page

with logged(snakemake.log[0]):
    write_scenes_page(snakemake.params.scenes, snakemake.output[0])
