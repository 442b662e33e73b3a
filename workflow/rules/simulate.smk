# Of each simulation its data, measured numbers, predictions and uncertainties; with `chunks` of each chunk, NAME/3-of-8,
# whose files are then put together, and stay: to measure anew, or to make a lost chunk again, needs them.


def of(key):
    """A setting of a rule's simulation, once its wildcards are known."""
    return lambda wildcards: settings_of(wildcards.simulation)[key]


# What a job that simulates may take.
BOUNDS = {
    "runtime": lambda wildcards, attempt: attempt * of("bound")(wildcards).minutes,
    "mem_mb": lambda wildcards, attempt: attempt * of("bound")(wildcards).megabytes,
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
        kernels=of("kernels"),
    output:
        data="results/data/{simulation}.nc",
    # Before what only draws, as all that the claims wait for: the report waits for them.
    priority: 2
    threads: lambda wildcards: of("bound")(wildcards).threads
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
        share=of("share"),
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
        chunks=lambda wildcards: JOINED[wildcards.joined]["chunks"],
        finest=lambda wildcards: JOINED[wildcards.joined]["finest"],
    output:
        joined="results/{joined}",
    priority: 2
    resources:
        runtime=lambda wildcards, attempt: attempt * 30,
        mem_mb=lambda wildcards, attempt: attempt * JOINED[wildcards.joined]["megabytes"],
    params:
        kind=lambda wildcards: JOINED[wildcards.joined]["kind"],
        record=lambda wildcards: JOINED[wildcards.joined]["record"],
    message:
        "Putting {wildcards.joined} together"
    run:
        run_step(rule, wildcards, input, output, params, threads)
