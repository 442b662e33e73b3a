# Sweeps that are divided into chunks, for a cluster: the files of the chunks are joined.

# Kind and simulation of each joined file, below results/.
KINDS = ("data", "measured", "predicted", "uncertainties", "coarser")
JOINED = {
    made(kind, [name])[0].removeprefix("results/"): (kind, name)
    for name in CHUNKS
    for kind in KINDS
}


wildcard_constraints:
    joined=one_of(JOINED),


def joined_inputs(wildcards):
    """Files of the chunks; uncertainties are joined in the order of the joined measurements."""
    kind, name = JOINED[wildcards.joined]
    finest = made("measured", [name] if kind == "uncertainties" else [])
    return {"chunks": made(kind, CHUNKS[name]), "finest": finest}


def joined_settings(wildcards):
    """Kind of a joined file, and what the runs of its simulation record."""
    kind, name = JOINED[wildcards.joined]
    return {"kind": kind, "record": SIMULATIONS[name].record}


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
        # A million runs took 1.2 kB each; other sweeps may take twice as much.
        mem_mb=lambda wildcards, attempt: attempt
        * (1000 + settings_of(JOINED[wildcards.joined][1])["runs"] // 400),
    params:
        settings=joined_settings,
        code=code_of("join"),
    message:
        "Joining the chunks: {output}"
    run:
        run_step("join", wildcards, input, output, params, threads, log)
