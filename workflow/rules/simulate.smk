# One data file a simulation of the configuration, one table of measured numbers, and one of their uncertainties.
# A simulation with `chunks` makes these of each chunk, NAME/3-of-8, and then puts them together. The files of the chunks
# stay: to measure anew, or to make a lost chunk again, needs them.


wildcard_constraints:
    simulation=ONE_JOB,


rule compile_kernels:
    input:
        sources("steps.compile_kernels"),
        LOCK,
    output:
        kernels="results/kernels.txt",
    log:
        "results/logs/compile_kernels.log",
    # Everything waits for it.
    priority: 2
    params:
        step="compile_kernels",
    message:
        "Compiling the lattice kernels (once)"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule simulate:
    input:
        sources("steps.simulate"),
        LOCK,
        kernels="results/kernels.txt",
    output:
        data="results/data/{simulation}.nc",
    log:
        "results/logs/simulate/{simulation}.log",
    # Before what only draws: the claims wait for the last of the measurements.
    priority: 1
    threads: job_threads
    resources:
        runtime=job_minutes,
        mem_mb=job_megabytes,
    params:
        step="simulate",
        simulation=lambda wildcards: wildcards.simulation,
        sweep=lambda wildcards: sweep_of_job(wildcards.simulation),
        configuration=lambda wildcards: configuration_of_data(wildcards.simulation),
    message:
        "Simulating {wildcards.simulation}"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule measure:
    input:
        sources("steps.measure"),
        data="results/data/{simulation}.nc",
    output:
        measured="results/measurements/{simulation}.csv",
    log:
        "results/logs/measure/{simulation}.log",
    priority: 1
    params:
        step="measure",
        measure=lambda wildcards: measure_of([Path(wildcards.simulation).parts[0]]),
        configuration=lambda wildcards: configuration_of_numbers(wildcards.simulation),
    message:
        "Measuring {wildcards.simulation}"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule predict:
    input:
        sources("steps.predict"),
        LOCK,
    output:
        predicted="results/predictions/{simulation}.csv",
    log:
        "results/logs/predict/{simulation}.log",
    params:
        step="predict",
        sweep=lambda wildcards: sweep_of_job(wildcards.simulation),
        share=config["measure"]["share"],
        still=config["measure"]["still"],
        configuration=lambda wildcards: configuration_of_numbers(wildcards.simulation),
    message:
        "Predicting {wildcards.simulation}"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule study_grid:
    input:
        sources("steps.study_grid"),
        LOCK,
        kernels="results/kernels.txt",
        finest="results/measurements/{simulation}.csv",
    output:
        uncertainties="results/uncertainties/{simulation}.csv",
        coarser="results/uncertainties/coarser/{simulation}.csv",
    log:
        "results/logs/study_grid/{simulation}.log",
    priority: 1
    resources:
        runtime=job_minutes,
        mem_mb=job_megabytes,
    params:
        step="study_grid",
        simulation=lambda wildcards: wildcards.simulation,
        sweeps=lambda wildcards: coarser_sweeps(wildcards.simulation),
        measure=lambda wildcards: measure_of([Path(wildcards.simulation).parts[0]]),
        configuration=lambda wildcards: configuration_of_numbers(wildcards.simulation),
    message:
        "Grid study of {wildcards.simulation}: on coarser lattices, for its uncertainty"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule join_data:
    input:
        sources("steps.join_data"),
        chunks=lambda wildcards: [f"results/data/{chunk}.nc" for chunk in CHUNKS[wildcards.simulation]],
    output:
        data="results/data/{simulation}.nc",
    log:
        "results/logs/join_data/{simulation}.log",
    wildcard_constraints:
        simulation=CHUNKED,
    resources:
        mem_mb=job_megabytes,
    params:
        step="join_data",
        record=lambda wildcards: SIMULATIONS[wildcards.simulation]["record"],
        configuration=lambda wildcards: configuration_of_data(wildcards.simulation),
    message:
        "Putting the data of {wildcards.simulation} together"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule join_measurements:
    input:
        sources("steps.join_measurements"),
        chunks=lambda wildcards: tables("measurements", CHUNKS[wildcards.simulation]),
    output:
        measured="results/measurements/{simulation}.csv",
    log:
        "results/logs/join_measurements/{simulation}.log",
    wildcard_constraints:
        simulation=CHUNKED,
    priority: 1
    params:
        step="join_measurements",
        configuration=lambda wildcards: configuration_of_numbers(wildcards.simulation),
    message:
        "Putting the measurements of {wildcards.simulation} together"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule join_uncertainties:
    input:
        sources("steps.join_uncertainties"),
        finest="results/measurements/{simulation}.csv",
        uncertainties=lambda wildcards: tables("uncertainties", CHUNKS[wildcards.simulation]),
        coarser=lambda wildcards: tables("uncertainties/coarser", CHUNKS[wildcards.simulation]),
    output:
        uncertainties="results/uncertainties/{simulation}.csv",
        coarser="results/uncertainties/coarser/{simulation}.csv",
    log:
        "results/logs/join_uncertainties/{simulation}.log",
    wildcard_constraints:
        simulation=CHUNKED,
    priority: 1
    resources:
        runtime=lambda wildcards, attempt: attempt * joining(wildcards).minutes,
        mem_mb=lambda wildcards, attempt: attempt * joining(wildcards).megabytes,
    params:
        step="join_uncertainties",
        configuration=lambda wildcards: configuration_of_numbers(wildcards.simulation),
    message:
        "Putting the grid studies of {wildcards.simulation} together"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)
