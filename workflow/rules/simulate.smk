# One data file a simulation block of the configuration; its scenes run in a pool of threads.


rule compile_kernels:
    input:
        KERNEL_SOURCES,
        LOCK,
    output:
        "results/kernels.txt",
    log:
        "results/logs/compile_kernels.log",
    benchmark:
        "results/benchmarks/compile_kernels.tsv"
    # Everything waits for it.
    priority: 2
    threads: 2
    message:
        "Compiling the lattice kernels (once)"
    script:
        "../scripts/compile_kernels.py"


wildcard_constraints:
    simulation=ONE_JOB,


rule simulate:
    input:
        SIMULATION_SOURCES,
        LOCK,
        kernels="results/kernels.txt",
    output:
        "results/data/{simulation}.nc",
    log:
        "results/logs/simulate/{simulation}.log",
    benchmark:
        "results/benchmarks/simulate/{simulation}.tsv"
    # Before what only draws: the claims wait for the last of the measurements.
    priority: 1
    threads: sweep_threads
    resources:
        runtime=sweep_minutes,
        mem_mb=sweep_megabytes,
    params:
        block=simulation_block,
    message:
        "Simulating {wildcards.simulation}"
    script:
        "../scripts/simulate.py"
