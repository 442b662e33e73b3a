# One rule a figure, all alike: a table of what is drawn (CSV), and the figure drawn from that table alone.

for figure, needs in (FIGURES | STUDIES).items():

    rule:
        name:
            figure
        input:
            sources(
                "figures/style.py",
                f"figures/{figure}.py",
                "figures/shared/*.py",
                "theory/*.py",
                "studies/edges.py",
            ),
            data=[f"results/data/{name}.nc" for name in needs.get("data", [])],
            measured=[f"results/measurements/{name}.csv" for name in needs.get("measured", [])]
            + [f"results/studies/{name}.csv" for name in needs.get("studies", [])],
        output:
            png=report(
                f"results/figures/{figure}.png",
                category="Figures of the paper" if figure in FIGURES else "Studies",
                labels={"figure": figure},
            ),
            pdf=f"results/figures/{figure}.pdf",
            csv=f"results/figures/{figure}.csv",
        log:
            f"results/logs/figures/{figure}.log",
        benchmark:
            f"results/benchmarks/figures/{figure}.tsv"
        params:
            figure=figure,
            settings=figure_settings(figure),
        message:
            f"Drawing {figure}"
        script:
            "../scripts/draw_figure.py"
