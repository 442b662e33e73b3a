# One data file a simulation of the configuration, one table of measured numbers, and one of their uncertainties.
# A simulation with `chunks` makes these of each chunk, NAME/3-of-8, and then puts them together. The files of the chunks
# stay: to measure anew, or to make a lost chunk again, needs them.


rule compile_kernels:
    output:
        kernels="results/kernels.txt",
    log:
        "results/logs/compile_kernels.log",
    # Everything waits for it.
    priority: 2
    message:
        "Compiling the lattice kernels (once)"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule simulate:
    input:
        kernels="results/kernels.txt",
    output:
        data="results/data/{simulation}.nc",
    log:
        "results/logs/simulate/{simulation}.log",
    # Before what only draws, as all that the claims wait for: the report waits for them.
    priority: 1
    threads: job_threads
    resources:
        runtime=job_minutes,
        mem_mb=job_megabytes,
    params:
        step=lambda wildcards: step_for("simulate", wildcards),
        simulation=lambda wildcards: wildcards.simulation,
        sweep=lambda wildcards: sweep_of_job(wildcards.simulation),
    message:
        "Simulating {wildcards.simulation}"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule measure:
    input:
        data="results/data/{simulation}.nc",
    output:
        measured="results/measurements/{simulation}.csv",
    log:
        "results/logs/measure/{simulation}.log",
    priority: 1
    params:
        measure=lambda wildcards: measure_of([Path(wildcards.simulation).parts[0]]),
    message:
        "Measuring {wildcards.simulation}"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule predict:
    output:
        predicted="results/predictions/{simulation}.csv",
    log:
        "results/logs/predict/{simulation}.log",
    priority: 1
    params:
        sweep=lambda wildcards: sweep_of_job(wildcards.simulation),
        share=lambda wildcards: measure_of([Path(wildcards.simulation).parts[0]])["share"],
        still=config["measure"]["still"],
    message:
        "Predicting {wildcards.simulation}"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule study_grid:
    input:
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
        step=lambda wildcards: step_for("study_grid", wildcards),
        simulation=lambda wildcards: wildcards.simulation,
        sweeps=lambda wildcards: coarser_sweeps(wildcards.simulation),
        measure=lambda wildcards: measure_of([Path(wildcards.simulation).parts[0]]),
    message:
        "Grid study of {wildcards.simulation}: on coarser lattices, for its uncertainty"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule join:
    input:
        chunks=lambda wildcards: chunks_of(wildcards.joined),
        finest=lambda wildcards: studied_in(wildcards.joined),
    output:
        joined="results/{joined}",
    log:
        "results/logs/join/{joined}.log",
    priority: 1
    resources:
        runtime=lambda wildcards, attempt: attempt * 30,
        mem_mb=joining_megabytes,
    params:
        kind=lambda wildcards: Path(wildcards.joined).parent.as_posix(),
        record=lambda wildcards: SIMULATIONS[Path(wildcards.joined).stem].record,
    message:
        "Putting {wildcards.joined} together"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)
