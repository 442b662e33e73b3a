# Rules for studies, for figures, and for the pages and animations of scenes.


rule study:
    input:
        unpack(study_inputs),
    output:
        table="results/studies/{study}.csv",
    log:
        "results/logs/study/{study}.log",
    priority: 2
    resources:
        # A study has all its data in memory.
        mem_mb=lambda wildcards, input, attempt: attempt * (1000 + 2 * input.size_mb),
    params:
        settings=study_settings,
        code=lambda wildcards: code_of(
            "run_study",
            f"slippulse_paper.studies.{study_of(wildcards)}",
            texts=texts_of(STUDY_NEEDS[study_of(wildcards)]),
        ),
    message:
        "Studying {wildcards.study}"
    run:
        run_step("run_study", wildcards, input, output, params, threads, log)


# A figure is drawn only from its table, which is the file CSV.
rule figure:
    input:
        unpack(lambda wildcards: inputs_of(ALL_FIGURES[wildcards.figure])),
    output:
        png=report(
            "results/figures/{figure}.png",
            caption="../report/figure.rst",
            category=figure_category,
            labels=lambda wildcards: {"figure": title_of(wildcards.figure)},
        ),
        pdf="results/figures/{figure}.pdf",
        csv="results/figures/{figure}.csv",
    log:
        "results/logs/figure/{figure}.log",
    # A reader can look at each figure as soon as its data exist.
    priority: 3
    params:
        settings=figure_settings,
        code=lambda wildcards: code_of(
            "draw_figure", f"slippulse_paper.figures.{module_of(wildcards.figure)}"
        ),
    message:
        "Drawing {wildcards.figure}"
    run:
        run_step("draw_figure", wildcards, input, output, params, threads, log)


# Computing times differ from run to run, and so these files are not among the results that are
# compared.
rule measure_seconds:
    input:
        studies=made("studies", ["accuracy_cost"]),
        kernels=made("kernels", ["fixed_step", "localised"]),
    output:
        **SECONDS,
    log:
        "results/logs/measure_seconds.log",
    priority: 2
    params:
        settings={},
        code=code_of("measure_seconds"),
    message:
        "Measuring seconds"
    run:
        run_step("measure_seconds", wildcards, input, output, params, threads, log)


rule draw_scene:
    input:
        data="results/data/{scene}.nc",
        measured="results/measurements/{scene}.csv",
        predicted="results/predictions/{scene}.csv",
        uncertainties="results/uncertainties/{scene}.csv",
    output:
        png=report(
            "results/scenes/{scene}.png",
            caption="../report/scene.rst",
            category="Scenes",
            labels=lambda wildcards: {"scene": TITLES[wildcards.scene]},
        ),
        pdf="results/scenes/{scene}.pdf",
        csv="results/scenes/{scene}.csv",
        numbers="results/scenes/{scene}_numbers.csv",
        html="results/scenes/{scene}.html",
    log:
        "results/logs/draw_scene/{scene}.log",
    params:
        settings=lambda wildcards: {
            "title": TITLES[wildcards.scene],
            "altered": note_of({"data": [wildcards.scene]}),
            "layer": LAYERS[wildcards.scene],
        },
        code=code_of("draw_scene", texts=templates("scene.html", "parts.html")),
    message:
        "Drawing scene {wildcards.scene}"
    run:
        run_step("draw_scene", wildcards, input, output, params, threads, log)


rule animate_scene:
    input:
        data="results/data/{scene}.nc",
    output:
        gif="results/scenes/{scene}.gif",
    log:
        "results/logs/animate_scene/{scene}.log",
    params:
        settings=lambda wildcards: {
            "title": TITLES[wildcards.scene],
            "layer": LAYERS[wildcards.scene],
        },
        code=code_of("animate_scene"),
    message:
        "Animating scene {wildcards.scene}"
    run:
        run_step("animate_scene", wildcards, input, output, params, threads, log)
