# Of each simulation its data, measured numbers, predictions and uncertainties; with `chunks` of each chunk, NAME/3-of-8,
# whose files are then put together, and stay: to measure anew, or to make a lost chunk again, needs them.


BOUNDS = {
    "runtime": lambda wildcards, attempt: attempt * of("bound")(wildcards)().minutes,
    "mem_mb": lambda wildcards, attempt: attempt * of("bound")(wildcards)().megabytes,
}


rule compile_kernels:
    output:
        kernels="results/kernels/{scheme}.txt",
    priority: 3
    message:
        "Compiling the kernels of scheme {wildcards.scheme} (once)"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule simulate:
    input:
        kernels=of("kernels"),
    output:
        data="results/data/{simulation}.nc",
    # Before what only draws, as all that the claims wait for: the report waits for them.
    priority: 2
    threads: lambda wildcards: of("bound")(wildcards)().threads
    resources:
        **BOUNDS,
    params:
        step=of("simulate"),
        sweep=of("sweep"),
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
        measure=of("measure"),
    message:
        "Measuring {wildcards.simulation}"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule predict:
    output:
        predicted="results/predictions/{simulation}.csv",
    priority: 2
    params:
        sweep=of("sweep"),
        topics=of("topics"),
        share=lambda wildcards: of("measure")(wildcards)["share"],
        still=config["measure"]["still"],
    message:
        "Predicting {wildcards.simulation}"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule study_grid:
    input:
        kernels=of("kernels"),
        finest="results/measurements/{simulation}.csv",
    output:
        uncertainties="results/uncertainties/{simulation}.csv",
        coarser="results/uncertainties/coarser/{simulation}.csv",
    priority: 2
    resources:
        **BOUNDS,
    params:
        step=of("study_grid"),
        sweeps=of("sweeps"),
        measure=of("measure"),
    message:
        "Grid study of {wildcards.simulation}: on coarser lattices, for its uncertainty"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule join:
    input:
        chunks=of_joined(lambda kind, name: made(kind, CHUNKS[name])),
        finest=of_joined(lambda kind, name: made("measured", [name] * (kind == "uncertainties"))),
    output:
        joined="results/{joined}",
    priority: 2
    resources:
        runtime=lambda wildcards, attempt: attempt * 30,
        # Measured over a million runs: 1.2 kB a run, and as much again for other sweeps.
        mem_mb=lambda wildcards, attempt: attempt
        * (1000 + settings_of(JOINED[wildcards.joined][1])["runs"] // 400),
    params:
        kind=of_joined(lambda kind, name: kind),
        record=of_joined(lambda kind, name: SIMULATIONS[name].record),
    message:
        "Putting {wildcards.joined} together"
    run:
        run_step(rule, wildcards, input, output, params, threads)
