# Single scenes by name: data, a figure, a page that stands alone, an animation. Not part of the paper.


rule scenes:
    input:
        expand("results/scenes/{scene}.{ending}", scene=SCENES, ending=["png", "html", "gif"]),
        "results/scenes/index.html",
    message:
        "Done: every scene is in results/scenes, as HTML, PNG, PDF, CSV and GIF"


use rule simulate as simulate_scene with:
    output:
        "results/scenes/data/{simulation}.nc",
    log:
        "results/logs/simulate_scene/{simulation}.log",
    benchmark:
        "results/benchmarks/simulate_scene/{simulation}.tsv"
    wildcard_constraints:
        simulation=SCENE_NAMES,
    threads: 1
    resources:
        runtime=scene_minutes,
        mem_mb=scene_megabytes,
    params:
        block=block_of_scene,
    message:
        "Simulating scene {wildcards.simulation}"


use rule measure as measure_scene with:
    input:
        MEASURE_SOURCES,
        data="results/scenes/data/{simulation}.nc",
    output:
        "results/scenes/data/{simulation}.csv",
    log:
        "results/logs/measure_scene/{simulation}.log",
    benchmark:
        "results/benchmarks/measure_scene/{simulation}.tsv"
    wildcard_constraints:
        simulation=SCENE_NAMES,
    message:
        "Measuring scene {wildcards.simulation}"


use rule study_grid as study_grid_of_scene with:
    input:
        SIMULATION_SOURCES,
        MEASURE_SOURCES,
        LOCK,
        kernels="results/kernels.txt",
        finest="results/scenes/data/{simulation}.csv",
    output:
        uncertainties="results/scenes/data/{simulation}_study.csv",
        tables="results/scenes/data/{simulation}_coarser.csv",
    log:
        "results/logs/study_grid_of_scene/{simulation}.log",
    benchmark:
        "results/benchmarks/study_grid_of_scene/{simulation}.tsv"
    wildcard_constraints:
        simulation=SCENE_NAMES,
    threads: 2
    resources:
        runtime=scene_minutes,
        mem_mb=scene_megabytes,
    params:
        blocks=coarser_blocks_of_scene,
        settings=config["measure"],
    message:
        "Grid study of scene {wildcards.simulation}"


rule draw_scene:
    input:
        sources("figures/style.py", "figures/scene.py", "figures/shared/*.py", "pages.py", "scene_page.py"),
        MEASURE_SOURCES,
        data="results/scenes/data/{scene}.nc",
        study="results/scenes/data/{scene}_study.csv",
    output:
        png=report(
            "results/scenes/{scene}.png",
            category="Scenes",
            labels={"scene": "{scene}"},
        ),
        pdf="results/scenes/{scene}.pdf",
        csv="results/scenes/{scene}.csv",
        numbers="results/scenes/{scene}_numbers.csv",
        html="results/scenes/{scene}.html",
    log:
        "results/logs/draw_scene/{scene}.log",
    benchmark:
        "results/benchmarks/draw_scene/{scene}.tsv"
    wildcard_constraints:
        scene=SCENE_NAMES,
    params:
        scene=lambda wildcards: {
            "title": SCENES[wildcards.scene]["title"],
            "share": config["measure"]["share"],
        },
    message:
        "Drawing scene {wildcards.scene}"
    script:
        "../scripts/draw_scene.py"


rule animate_scene:
    input:
        sources("figures/style.py", "figures/scene_animation.py", "figures/shared/*.py"),
        data="results/scenes/data/{scene}.nc",
    output:
        "results/scenes/{scene}.gif",
    log:
        "results/logs/animate_scene/{scene}.log",
    benchmark:
        "results/benchmarks/animate_scene/{scene}.tsv"
    wildcard_constraints:
        scene=SCENE_NAMES,
    params:
        title=lambda wildcards: SCENES[wildcards.scene]["title"],
    message:
        "Animating scene {wildcards.scene}"
    script:
        "../scripts/animate_scene.py"


rule write_scenes_page:
    input:
        sources("index_page.py", "pages.py"),
        expand("results/scenes/{scene}.png", scene=SCENES),
    output:
        "results/scenes/index.html",
    log:
        "results/logs/write_scenes_page.log",
    benchmark:
        "results/benchmarks/write_scenes_page.tsv"
    params:
        scenes={name: scene["title"] for name, scene in SCENES.items()},
    message:
        "Writing the list of scenes"
    script:
        "../scripts/write_scenes_page.py"
