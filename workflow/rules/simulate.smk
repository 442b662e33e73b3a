# Rules for the data, measured numbers, predictions and uncertainties of each simulation or chunk.

# Limits of time and memory on a cluster. After a failure, the next attempt has larger limits.
BOUNDS = {
    "runtime": lambda wildcards, attempt: attempt * bound_of_job(wildcards).minutes,
    "mem_mb": lambda wildcards, attempt: attempt * bound_of_job(wildcards).megabytes,
}


rule compile_kernels:
    output:
        kernels="results/kernels/{scheme}.txt",
    log:
        "results/logs/compile_kernels/{scheme}.log",
    priority: 3
    params:
        settings={},
        code=code_of("compile_kernels"),
    message:
        "Compiling the kernels: {wildcards.scheme} (once)"
    run:
        run_step("compile_kernels", wildcards, input, output, params, threads, log)


rule simulate:
    input:
        kernels=setting("kernels"),
    output:
        data="results/data/{simulation}.nc",
    log:
        "results/logs/simulate/{simulation}.log",
    # The report waits for the claims, and so the inputs of the claims are made first.
    priority: 2
    threads: lambda wildcards: bound_of_job(wildcards).threads
    resources:
        **BOUNDS,
    params:
        settings=lambda wildcards: {
            key: settings_of(wildcards.simulation)[key] for key in ("solver", "sweep")
        },
        code=lambda wildcards: code_of("simulate", solver_of(wildcards)),
    message:
        "Simulating {wildcards.simulation}"
    run:
        run_step("simulate", wildcards, input, output, params, threads, log)


rule measure:
    input:
        data="results/data/{simulation}.nc",
    output:
        measured="results/measurements/{simulation}.csv",
    log:
        "results/logs/measure/{simulation}.log",
    priority: 2
    params:
        settings=lambda wildcards: {"measure": settings_of(wildcards.simulation)["measure"]},
        code=code_of("measure"),
    message:
        "Measuring {wildcards.simulation}"
    run:
        run_step("measure", wildcards, input, output, params, threads, log)


rule predict:
    output:
        predicted="results/predictions/{simulation}.csv",
    log:
        "results/logs/predict/{simulation}.log",
    priority: 2
    params:
        settings=lambda wildcards: {
            "sweep": settings_of(wildcards.simulation)["sweep"],
            "topics": settings_of(wildcards.simulation)["topics"],
            "fraction": settings_of(wildcards.simulation)["measure"]["fraction"],
            "still": config["measure"]["still"],
        },
        code=lambda wildcards: code_of("predict", *prediction_modules(wildcards)),
    message:
        "Predicting {wildcards.simulation}"
    run:
        run_step("predict", wildcards, input, output, params, threads, log)


rule study_grid:
    input:
        kernels=setting("kernels"),
        finest="results/measurements/{simulation}.csv",
    output:
        uncertainties="results/uncertainties/{simulation}.csv",
        coarser="results/uncertainties/coarser/{simulation}.csv",
    log:
        "results/logs/study_grid/{simulation}.log",
    priority: 2
    resources:
        **BOUNDS,
    params:
        settings=lambda wildcards: {
            key: settings_of(wildcards.simulation)[key] for key in ("solver", "sweeps", "measure")
        },
        code=lambda wildcards: code_of("study_grid", solver_of(wildcards)),
    message:
        "Grid study of {wildcards.simulation} on coarser lattices, for the uncertainties"
    run:
        run_step("study_grid", wildcards, input, output, params, threads, log)
