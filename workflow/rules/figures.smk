# One rule a figure, all alike: a table of what is drawn (CSV), and the figure drawn from that table alone.

for figure, needs in NEEDS.items():

    rule:
        name:
            figure
        input:
            **inputs_of(needs),
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
        params:
            step="draw_figure",
            figure=figure,
            values=settings_of_figure(figure),
        message:
            f"Drawing {figure}"
        run:
            run_step(rule, wildcards, input, output, params, threads, log)


# The short name of each figure of the paper.
for figure in FIGURES:

    rule:
        name:
            figure.partition("_")[0]
        input:
            figure_files([figure]),
