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


use rule measure as measure_coarser with:
    input:
        MEASURE_SOURCES,
        data="results/data/coarser/{simulation}_x{coarser}.nc",
    output:
        "results/measurements/coarser/{simulation}_x{coarser}.csv",
    log:
        "results/logs/measure_coarser/{simulation}_x{coarser}.log",
    benchmark:
        "results/benchmarks/measure_coarser/{simulation}_x{coarser}.tsv"
    message:
        "Measuring {wildcards.simulation} on a lattice {wildcards.coarser} times coarser"


rule estimate_uncertainty:
    input:
        MEASURE_SOURCES,
        finest="results/measurements/{simulation}.csv",
        coarser=[
            f"results/measurements/coarser/{{simulation}}_x{float(factor)}.csv"
            for factor in ACCURACY["coarser"]
        ],
    output:
        "results/uncertainties/{simulation}.csv",
    log:
        "results/logs/estimate_uncertainty/{simulation}.log",
    benchmark:
        "results/benchmarks/estimate_uncertainty/{simulation}.tsv"
    params:
        factors=ACCURACY["coarser"],
    message:
        "Grid study of {wildcards.simulation}"
    script:
        "../scripts/estimate_uncertainty.py"
