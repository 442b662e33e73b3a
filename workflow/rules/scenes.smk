# Single scenes by name: a figure, a page that stands alone, an animation; and sweeps that an overlay adds.


rule scenes:
    input:
        scene_files(SCENES),
        expand("results/scenes/{scene}.gif", scene=SCENES),
        "results/scenes/index.html",
    message:
        "Done: every scene is in results/scenes, as HTML, PNG, PDF, CSV and GIF"


rule draw_scene:
    input:
        data="results/data/{scene}.nc",
        measured="results/measurements/{scene}.csv",
        predicted="results/predictions/{scene}.csv",
        uncertainties="results/uncertainties/{scene}.csv",
    output:
        png=report("results/scenes/{scene}.png", category="Scenes", labels={"scene": "{scene}"}),
        pdf="results/scenes/{scene}.pdf",
        csv="results/scenes/{scene}.csv",
        numbers="results/scenes/{scene}_numbers.csv",
        html="results/scenes/{scene}.html",
    log:
        "results/logs/draw_scene/{scene}.log",
    wildcard_constraints:
        scene="|".join(SCENES) or "(?!)",
    params:
        scene=lambda wildcards: wildcards.scene,
        title=lambda wildcards: SCENES[wildcards.scene]["title"],
    message:
        "Drawing scene {wildcards.scene}"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule animate_scene:
    input:
        data="results/data/{scene}.nc",
    output:
        gif="results/scenes/{scene}.gif",
    log:
        "results/logs/animate_scene/{scene}.log",
    wildcard_constraints:
        scene="|".join(SCENES) or "(?!)",
    params:
        title=lambda wildcards: SCENES[wildcards.scene]["title"],
    message:
        "Animating scene {wildcards.scene}"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule write_scenes_page:
    input:
        expand("results/scenes/{scene}.png", scene=SCENES),
    output:
        html="results/scenes/index.html",
    log:
        "results/logs/write_scenes_page.log",
    params:
        scenes={name: scene["title"] for name, scene in SCENES.items()},
    message:
        "Writing the list of scenes"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule draw_sweep:
    input:
        measured="results/measurements/{sweep}.csv",
        predicted="results/predictions/{sweep}.csv",
    output:
        png=report("results/figures/sweep_{sweep}.png", category="Sweeps", labels={"sweep": "{sweep}"}),
        pdf="results/figures/sweep_{sweep}.pdf",
        csv="results/figures/sweep_{sweep}.csv",
    log:
        "results/logs/draw_sweep/{sweep}.log",
    wildcard_constraints:
        sweep="|".join(CONFIG.simulations),
    message:
        "Drawing sweep {wildcards.sweep}"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)
