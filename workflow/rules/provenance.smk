# What there is when everything is made, what it was made from, and the page that leads to it.

from slippulse.data.provenance import source_files

DRAWN = simulations_of(NEEDS)
STUDIED = sorted({*CLAIM_SIMULATIONS, *OWN_SIMULATIONS, *SCENES})
OWN_SWEEPS = figure_files(f"sweep_{name}" for name in OWN_SIMULATIONS)
RESULTS = [
    *figure_files(NEEDS),
    *(f"results/data/{name}.nc" for name in sorted({*DRAWN, *STUDIED})),
    *tables("measurements", sorted({*DRAWN, *STUDIED})),
    *tables("uncertainties", STUDIED),
    *(f"results/studies/{name}.csv" for name in CONFIG.studies or ALL_STUDIES),
    *scene_files(SCENES),
    *OWN_SWEEPS,
    "results/claims.json",
    "results/findings.json",
    "results/claims.html",
    "results/explorer.html",
    *(f"results/manuscript/{name}.{ending}" for name in DOCUMENTS for ending in ("html", "pdf")),
]
# What a draft makes unless everything is asked for: the figures of the paper with what they are drawn from, and what
# an overlay adds.
FIRST = [
    *figure_files(FIGURES),
    *(f"results/data/{name}.nc" for name in simulations_of(FIGURES)),
    *tables(
        "measurements",
        sorted(
            {*OWN_SIMULATIONS, *(name for figure in FIGURES for name in NEEDS[figure].get("measured", []))}
        ),
    ),
    *scene_files(OWN_SCENES),
    *OWN_SWEEPS,
]


rule write_provenance:
    input:
        # It notes a digest of them all.
        [path.as_posix() for path in source_files(".")],
        results=RESULTS,
        captions="manuscript/captions.yaml",
    output:
        provenance="results/provenance.json",
        checksums="results/checksums.txt",
        manifest="results/codecheck.yml",
    log:
        "results/logs/write_provenance.log",
    params:
        config=config,
        shipped=SHIPPED,
    message:
        "Noting what the results were made from"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)


rule write_index:
    input:
        captions="manuscript/captions.yaml",
        summary="manuscript/summary.yaml",
        pictures=[f"results/figures/{name}.png" for name in NEEDS],
        sweeps=OWN_SWEEPS,
        scenes=scene_files(SCENES),
        claims="results/claims.json",
        findings="results/findings.json",
        provenance="results/provenance.json",
        report="results/manuscript/replication.html",
        explorer="results/explorer.html",
    output:
        html="results/index.html",
    log:
        "results/logs/write_index.log",
    params:
        galleries={"The figures of the paper": FIGURES, "Beyond the paper": STUDIES}
        | ({"Sweeps of your own": [f"sweep_{name}" for name in OWN_SIMULATIONS]} if OWN_SIMULATIONS else {}),
        scenes={name: scene["title"] for name, scene in SCENES.items()},
    message:
        "Writing results/index.html, the page to open"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)
