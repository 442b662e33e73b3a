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
    params:
        settings=config["measure"],
    message:
        "Measuring {wildcards.simulation}"
    script:
        "../scripts/measure.py"
