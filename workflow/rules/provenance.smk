# What the results were made from, and what they are: provenance, checksums, manifest.

NEEDS = list((FIGURES | STUDIES).values())
# Every file of the paper but logs, benchmarks and what is written here.
RESULTS = sorted(
    {
        *figure_files(FIGURES | STUDIES),
        *(f"results/data/{name}.nc" for needs in NEEDS for name in needs.get("data", [])),
        *(f"results/data/{name}.nc" for needs in NEEDS for name in needs.get("measured", [])),
        *(f"results/data/{name}.nc" for name in CLAIM_SIMULATIONS),
        *(f"results/measurements/{name}.csv" for needs in NEEDS for name in needs.get("measured", [])),
        *(f"results/measurements/{name}.csv" for name in CLAIM_SIMULATIONS),
        *(f"results/studies/{name}.csv" for needs in NEEDS for name in needs.get("studies", [])),
        "results/studies/requirements.csv",
        *(f"results/uncertainties/{name}.csv" for name in CLAIM_SIMULATIONS),
        "results/claims.json",
        "results/claims.html",
        "results/manuscript/replication.html",
        "results/manuscript/replication.pdf",
    }
)


rule write_provenance:
    input:
        sources("provenance.py"),
        LOCK,
        captions="manuscript/captions.yaml",
        files=RESULTS,
    output:
        provenance="results/provenance.json",
        checksums="results/checksums.txt",
        manifest="results/codecheck.yml",
    log:
        "results/logs/write_provenance.log",
    benchmark:
        "results/benchmarks/write_provenance.tsv"
    params:
        root=lambda wildcards: str(workflow.basedir),
        config=builtins_of(config),
        shipped=builtins_of(SHIPPED),
    message:
        "Noting what the results were made from"
    script:
        "../scripts/write_provenance.py"


rule write_index:
    input:
        sources("index_page.py", "pages.py"),
        captions="manuscript/captions.yaml",
        summary="manuscript/summary.yaml",
        pngs=[f"results/figures/{name}.png" for name in FIGURES | STUDIES],
        claims="results/claims.json",
        provenance="results/provenance.json",
        report="results/manuscript/replication.html",
    output:
        "results/index.html",
    log:
        "results/logs/write_index.log",
    benchmark:
        "results/benchmarks/write_index.tsv"
    params:
        galleries={"Figures of the paper": list(FIGURES), "Studies beside the paper": list(STUDIES)},
        scenes={name: scene["title"] for name, scene in SCENES.items()},
    message:
        "Writing results/index.html, the page to open"
    script:
        "../scripts/write_index.py"
