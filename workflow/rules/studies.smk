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


rule study_pipeline_time:
    input:
        sources("figures/style.py", "figures/pipeline_time.py", "benchmark/records.py"),
        figure_files(FIGURES | STUDIES),
        "results/claims.json",
        "results/studies/requirements.csv",
    output:
        png=report(
            "results/figures/study_pipeline_time.png",
            category="Studies",
            labels={"figure": "study_pipeline_time"},
        ),
        pdf="results/figures/study_pipeline_time.pdf",
        csv="results/figures/study_pipeline_time.csv",
    log:
        "results/logs/study_pipeline_time.log",
    benchmark:
        "results/benchmarks/study_pipeline_time.tsv"
    message:
        "Drawing where the time went"
    script:
        "../scripts/draw_pipeline_time.py"
