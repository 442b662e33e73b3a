# The page on which a rupture is explored with sliders: the exact solution in the browser, with measured runs beside it.


rule write_explorer:
    input:
        law="results/studies/explorer_law.csv",
        measured=tables("measurements", EXPLORER_SIMULATIONS),
    output:
        html="results/explorer.html",
    log:
        "results/logs/write_explorer.log",
    message:
        "Writing results/explorer.html"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)
