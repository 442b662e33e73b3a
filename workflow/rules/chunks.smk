# A sweep with `chunks`: rules simulate, measure and study_grid make each chunk, NAME/3-of-8, as they make a sweep that
# has none; these put the chunks together. The files of the chunks stay, as data of any sweep do: to measure anew, or
# to make one lost chunk again, needs them. Nothing but a target of that name needs the joined data.


rule join_data:
    input:
        sources("chunks.py", "join.py", "points.py", "sweep.py"),
        chunks=chunks_of("results/data/{}.nc"),
    output:
        "results/data/{simulation}.nc",
    log:
        "results/logs/join_data/{simulation}.log",
    benchmark:
        "results/benchmarks/join_data/{simulation}.tsv"
    wildcard_constraints:
        simulation=CHUNKED,
    resources:
        mem_mb=join_data_megabytes,
    params:
        record=lambda wildcards: config["simulations"][wildcards.simulation]["record"],
    message:
        "Putting the data of {wildcards.simulation} together"
    script:
        "../scripts/join_data.py"


rule join_measurements:
    input:
        sources("chunks.py", "join.py"),
        chunks=chunks_of("results/measurements/{}.csv"),
    output:
        "results/measurements/{simulation}.csv",
    log:
        "results/logs/join_measurements/{simulation}.log",
    benchmark:
        "results/benchmarks/join_measurements/{simulation}.tsv"
    wildcard_constraints:
        simulation=CHUNKED,
    priority: 1
    message:
        "Putting the measurements of {wildcards.simulation} together"
    script:
        "../scripts/join_measurements.py"


rule join_uncertainties:
    input:
        sources("chunks.py", "join.py", "measure/table.py", "measure/uncertainty.py"),
        finest="results/measurements/{simulation}.csv",
        uncertainties=chunks_of("results/uncertainties/{}.csv"),
        tables=chunks_of("results/uncertainties/coarser/{}.csv"),
    output:
        uncertainties="results/uncertainties/{simulation}.csv",
        tables="results/uncertainties/coarser/{simulation}.csv",
    log:
        "results/logs/join_uncertainties/{simulation}.log",
    benchmark:
        "results/benchmarks/join_uncertainties/{simulation}.tsv"
    wildcard_constraints:
        simulation=CHUNKED,
    priority: 1
    resources:
        runtime=join_uncertainties_minutes,
        mem_mb=join_uncertainties_megabytes,
    message:
        "Putting the grid studies of {wildcards.simulation} together"
    script:
        "../scripts/join_uncertainties.py"
