# One data file a simulation of the configuration, one table of measured numbers, and one of their uncertainties.
# A simulation with `chunks` makes these of each chunk, NAME/3-of-8, and then puts them together. The files of the chunks
# stay: to measure anew, or to make a lost chunk again, needs them.

# What a job that simulates may take.
BOUNDS = {
    "runtime": lambda wildcards, attempt: attempt * bound_of_job(wildcards.simulation).minutes,
    "mem_mb": lambda wildcards, attempt: attempt * bound_of_job(wildcards.simulation).megabytes,
}


rule compile_kernels:
    output:
        kernels="results/kernels.txt",
    # Everything waits for it.
    priority: 3
    message:
        "Compiling the lattice kernels (once)"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule simulate:
    input:
        kernels=lambda wildcards: kernels_for(wildcards.simulation),
    output:
        data="results/data/{simulation}.nc",
    # Before what only draws, as all that the claims wait for: the report waits for them.
    priority: 2
    threads: lambda wildcards: bound_of_job(wildcards.simulation).threads
    resources:
        **BOUNDS,
    params:
        step=lambda wildcards: step_for("simulate", wildcards.simulation),
        sweep=lambda wildcards: promised_sweep(wildcards.simulation),
    message:
        "Simulating {wildcards.simulation}"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule measure:
    input:
        data="results/data/{simulation}.nc",
    output:
        measured="results/measurements/{simulation}.csv",
    priority: 2
    params:
        measure=lambda wildcards: measure_of(wildcards.simulation),
    message:
        "Measuring {wildcards.simulation}"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule predict:
    output:
        predicted="results/predictions/{simulation}.csv",
    priority: 2
    params:
        sweep=lambda wildcards: promised_sweep(wildcards.simulation),
        topics=lambda wildcards: topics_of(wildcards.simulation.partition("/")[0]),
        share=lambda wildcards: measure_of(wildcards.simulation)["share"],
        still=config["measure"]["still"],
    message:
        "Predicting {wildcards.simulation}"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule study_grid:
    input:
        kernels=lambda wildcards: kernels_for(wildcards.simulation),
        finest="results/measurements/{simulation}.csv",
    output:
        uncertainties="results/uncertainties/{simulation}.csv",
        coarser="results/uncertainties/coarser/{simulation}.csv",
    priority: 2
    resources:
        **BOUNDS,
    params:
        step=lambda wildcards: step_for("study_grid", wildcards.simulation),
        # On the coarser lattices of the preset, by factor of the spacing.
        sweeps=lambda wildcards: {
            float(factor): promised_sweep(wildcards.simulation, float(factor))
            for factor in ACCURACY["coarser"]
        },
        measure=lambda wildcards: measure_of(wildcards.simulation),
    message:
        "Grid study of {wildcards.simulation}: on coarser lattices, for its uncertainty"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule join:
    input:
        # In the order of their numbers.
        chunks=lambda wildcards: [
            f"results/{joined_path(wildcards).parent / chunk}{joined_path(wildcards).suffix}"
            for chunk in CHUNKS[joined_path(wildcards).stem]
        ],
        # The measurements that a grid study is of.
        finest=lambda wildcards: made(
            "measured",
            [joined_path(wildcards).stem] * (joined_path(wildcards).parent.name == "uncertainties"),
        ),
    output:
        joined="results/{joined}",
    priority: 2
    resources:
        runtime=lambda wildcards, attempt: attempt * 30,
        # Measured over a million runs: 1.2 kB a run, and as much again for other sweeps.
        mem_mb=lambda wildcards, attempt: attempt
        * (1000 + run_count(sweep_of(joined_path(wildcards).stem)) // 400),
    params:
        kind=lambda wildcards: joined_path(wildcards).parent.as_posix(),
        record=lambda wildcards: SIMULATIONS[joined_path(wildcards).stem].record,
    message:
        "Putting {wildcards.joined} together"
    run:
        run_step(rule, wildcards, input, output, params, threads)
