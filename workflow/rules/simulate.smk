# Data, measured numbers, predictions and uncertainties of each simulation, or of its chunks.

BOUNDS = {
    "runtime": lambda wildcards, attempt: attempt * setting("bound")(wildcards)().minutes,
    "mem_mb": lambda wildcards, attempt: attempt * setting("bound")(wildcards)().megabytes,
}


# The rules have this in common.
rule step:
    input:
        environment,
    log:
        "results/logs/step.log",
    # The report waits for the claims: what these wait for goes before what only draws.
    priority: 2
    message:
        "Writing {output[0]}"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


use rule step as compile_kernels with:
    output:
        kernels="results/kernels/{scheme}.txt",
    log:
        "results/logs/compile_kernels/{scheme}.log",
    priority: 3
    message:
        "Compiling the kernels: {wildcards.scheme} (once)"


use rule step as simulate with:
    input:
        environment,
        kernels=setting("kernels"),
    output:
        data="results/data/{simulation}.nc",
    log:
        "results/logs/simulate/{simulation}.log",
    threads: lambda wildcards: setting("bound")(wildcards)().threads
    resources:
        **BOUNDS,
    params:
        solver=setting("solver"),
        sweep=setting("sweep"),
    message:
        "Simulating {wildcards.simulation}"


use rule step as measure with:
    input:
        environment,
        data="results/data/{simulation}.nc",
    output:
        measured="results/measurements/{simulation}.csv",
    log:
        "results/logs/measure/{simulation}.log",
    params:
        measure=setting("measure"),
    message:
        "Measuring {wildcards.simulation}"


use rule step as predict with:
    output:
        predicted="results/predictions/{simulation}.csv",
    log:
        "results/logs/predict/{simulation}.log",
    params:
        sweep=setting("sweep"),
        topics=setting("topics"),
        share=lambda wildcards: setting("measure")(wildcards)["share"],
        still=config["measure"]["still"],


use rule step as study_grid with:
    input:
        environment,
        kernels=setting("kernels"),
        finest="results/measurements/{simulation}.csv",
    output:
        uncertainties="results/uncertainties/{simulation}.csv",
        coarser="results/uncertainties/coarser/{simulation}.csv",
    log:
        "results/logs/study_grid/{simulation}.log",
    resources:
        **BOUNDS,
    params:
        solver=setting("solver"),
        sweeps=setting("sweeps"),
        measure=setting("measure"),
    message:
        "Grid study of {wildcards.simulation}: on coarser lattices, for its uncertainty"


use rule step as join with:
    input:
        environment,
        chunks=joined(lambda kind, name: made(kind, CHUNKS[name])),
        finest=joined(
            lambda kind, name: made("measured", [name] if kind == "uncertainties" else [])
        ),
    output:
        joined="results/{joined}",
    log:
        "results/logs/join/{joined}.log",
    resources:
        runtime=lambda wildcards, attempt: attempt * 30,
        # A million runs took 1.2 kB each; other sweeps may take twice as much.
        mem_mb=lambda wildcards, attempt: attempt
        * (1000 + settings_of(JOINED[wildcards.joined][1])["runs"] // 400),
    params:
        kind=joined(lambda kind, name: kind),
        record=joined(lambda kind, name: SIMULATIONS[name].record),
