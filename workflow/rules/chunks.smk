# A rule that joins the files of chunks. Sweeps may be divided into chunks, mostly on a cluster.


rule join:
    input:
        unpack(joined_inputs),
    output:
        joined="results/{joined}",
    log:
        "results/logs/join/{joined}.log",
    priority: 2
    resources:
        runtime=lambda wildcards, attempt: attempt * 30,
        mem_mb=lambda wildcards, input, attempt: attempt * joined_megabytes(wildcards, input),
    params:
        settings=joined_settings,
        code=code_of("join"),
    message:
        "Joining the chunks: {output}"
    run:
        run_step("join", wildcards, input, output, params, threads, log)
