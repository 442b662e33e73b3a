# From data to numbers: one table a simulation block, one row a run.


rule measure:
    input:
        MEASURE_SOURCES,
        data="results/data/{simulation}.nc",
    output:
        "results/measurements/{simulation}.csv",
    log:
        "results/logs/measure/{simulation}.log",
    benchmark:
        "results/benchmarks/measure/{simulation}.tsv"
    priority: 1
    params:
        settings=config["measure"],
    message:
        "Measuring {wildcards.simulation}"
    script:
        "../scripts/measure.py"


rule study_grid:
    input:
        SIMULATION_SOURCES,
        MEASURE_SOURCES,
        LOCK,
        kernels="results/kernels.txt",
        finest="results/measurements/{simulation}.csv",
    output:
        uncertainties="results/uncertainties/{simulation}.csv",
        tables="results/uncertainties/coarser/{simulation}.csv",
    log:
        "results/logs/study_grid/{simulation}.log",
    benchmark:
        "results/benchmarks/study_grid/{simulation}.tsv"
    priority: 1
    threads: 1
    resources:
        runtime=sweep_minutes,
        mem_mb=sweep_megabytes,
    params:
        blocks=coarser_blocks,
        settings=config["measure"],
    message:
        "Grid study of {wildcards.simulation}: on coarser lattices, for its uncertainty"
    script:
        "../scripts/study_grid.py"
