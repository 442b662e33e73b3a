# Tables of studies; figures of the paper, of studies and of sweeps; single scenes by name.

for study, needs in STUDY_NEEDS.items():
    swept = {name: settings_of(name)["sweep"] for name in needs.get("sweeps", ())}
    reached = [scheme for scheme in KERNELS if KERNELS[scheme] in sources(f"studies.{study}")]

    rule:
        name:
            f"study_of_{study}"
        input:
            environment,
            **inputs_of(needs),
            kernels=made("kernels", reached),
        output:
            table=f"results/studies/{study}.csv",
        log:
            f"results/logs/study_of_{study}.log",
        priority: 2
        params:
            step="run_study",
            study=study,
            values=selected(config, needs.get("settings", ()), {"sweeps": swept}),
        message:
            f"Studying {study}"
        run:
            run_step(rule, wildcards, input, output, params, threads, log)


# A figure is drawn from its table (CSV) alone.
for figure, needs in (NEEDS | SWEEPS).items():
    category = "Figures of the paper" if figure in FIGURES else "Studies and sweeps"

    rule:
        name:
            figure
        input:
            environment,
            **inputs_of(needs),
        output:
            png=report(f"results/figures/{figure}.png", category=category),
            pdf=f"results/figures/{figure}.pdf",
            csv=f"results/figures/{figure}.csv",
        log:
            f"results/logs/{figure}.log",
        # The report waits for the figures: they go before scenes and the explorer.
        priority: 1
        params:
            step="draw_figure",
            figure=figure if figure in NEEDS else "user_defined_sweep",
            values=selected(config, needs.get("settings", ()), config["figures"].get(figure, {})),
            altered=note_of(needs, f"figures.{figure}"),
        message:
            f"Drawing {figure}"
        run:
            run_step(rule, wildcards, input, output, params, threads, log)


use rule step as draw_scene with:
    input:
        environment,
        data="results/data/{scene}.nc",
        measured="results/measurements/{scene}.csv",
        predicted="results/predictions/{scene}.csv",
        uncertainties="results/uncertainties/{scene}.csv",
    output:
        png=report("results/scenes/{scene}.png", category="Scenes"),
        pdf="results/scenes/{scene}.pdf",
        csv="results/scenes/{scene}.csv",
        numbers="results/scenes/{scene}_numbers.csv",
        html="results/scenes/{scene}.html",
    log:
        "results/logs/draw_scene/{scene}.log",
    priority: 0
    params:
        title=lambda wildcards: TITLES[wildcards.scene],
        layer=lambda wildcards: LAYERS[wildcards.scene],
        altered=lambda wildcards: note_of({"data": [wildcards.scene]}),
    message:
        "Drawing scene {wildcards.scene}"


use rule step as animate_scene with:
    input:
        environment,
        data="results/data/{scene}.nc",
    output:
        gif="results/scenes/{scene}.gif",
    log:
        "results/logs/animate_scene/{scene}.log",
    priority: 0
    params:
        title=lambda wildcards: TITLES[wildcards.scene],
        layer=lambda wildcards: LAYERS[wildcards.scene],
