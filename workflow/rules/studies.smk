# Studies of the solver itself: one table each, from runs of their own.


rule study:
    input:
        SIMULATION_SOURCES,
        MEASURE_SOURCES,
        sources("studies/*.py"),
        LOCK,
        kernels="results/kernels.txt",
    output:
        "results/studies/{study}.csv",
    log:
        "results/logs/studies/{study}.log",
    benchmark:
        "results/benchmarks/studies/{study}.tsv"
    params:
        study=lambda wildcards: wildcards.study,
        settings=study_settings,
    message:
        "Studying {wildcards.study}"
    script:
        "../scripts/run_study.py"
