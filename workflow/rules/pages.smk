# Rules for pages: claims, explorer, report, scenes, and the index of all results.

from slippulse_paper.records.provenance import changes, source_files

CLAIM_STUDIES = (
    "derivations friction_laws layer layer_healing layer_map open_choices published_figure"
    " published_scheme rate_dependence"
    " rough_checks rough_prestress"
).split()
# Names of the report and its supplement.
DOCUMENTS = declared("report.manuscript", "DOCUMENTS")
# Results with a checksum.
RESULTS = [
    # Snakemake's report has this order.
    *[f"results/{name}" for name in ("claims.html", "claims.json", "findings.json")],
    "results/explorer.html",
    *made("figures", [*NEEDS, *SWEEPS]),
    *made("data", SIMULATIONS),
    *made("measured", SIMULATIONS),
    *made("uncertainties", [*CLAIM_SIMULATIONS, *OWN_SIMULATIONS, *SCENES]),
    *made("studies", CONFIG.studies or STUDY_NEEDS),
    *made("scenes", SCENES),
    *expand("results/manuscript/{document}.{ending}", document=DOCUMENTS, ending=("html", "pdf")),
]
EVERYTHING = [*RESULTS, *SECONDS.values(), "results/provenance.json", "results/index.html"]
# By default, a draft makes the figures of the paper, and everything that an overlay adds.
DRAFT = made("figures", [*FIGURES, *SWEEPS]) + made("measured", OWN_SIMULATIONS)
DRAFT += made("scenes", [name for name in SCENES if name not in SHIPPED.get("scenes", {})])
# Files of the manuscript that the claims, the report and the index read.
TEXTS = ("captions", "claims", "errata", "metadata", "shipped_verdicts", "statements", "summary")
CLAIM_TEXTS = ["manuscript/claims.yaml", "manuscript/statements.yaml"]
REPORT_TEXTS = [
    "manuscript/references.bib",
    *(f"manuscript/{text}.yaml" for text in TEXTS),
    *(f"manuscript/{document}.md" for document in DOCUMENTS),
    "config/config.yaml",
    "CITATION.cff",
]
INDEX_TEXTS = [f"manuscript/{text}.yaml" for text in ("captions", "errata", "summary")]


rule write_claims:
    input:
        measured=made("measured", [*CLAIM_SIMULATIONS, "front_speed"]),
        coarser=made("coarser", CLAIM_SIMULATIONS),
        uncertainties=made("uncertainties", CLAIM_SIMULATIONS),
        predicted=made("predicted", CLAIM_PREDICTED),
        studies=made("studies", CLAIM_STUDIES),
        texts=project("manuscript/claims.yaml"),
        statements=project("manuscript/statements.yaml"),
    output:
        json="results/claims.json",
        findings="results/findings.json",
        html=report("results/claims.html", caption="../report/claims.rst", category="Claims"),
    log:
        "results/logs/write_claims.log",
    priority: 2
    params:
        settings={
            **{key: config[key] for key in ("claims", "published", "measure")},
            "damping_ratio": config["model"]["damping_ratio"],
            "altered": changes(SHIPPED, config),
        },
        code=code_of("write_claims", texts=[*CLAIM_TEXTS, *templates("claims.html", "parts.html")]),
    message:
        "Judging the claims"
    run:
        run_step("write_claims", wildcards, input, output, params, threads, log)


rule write_explorer:
    input:
        law="results/studies/explorer_law.csv",
        measured=made("measured", declared("steps.write_explorer", "SIMULATIONS")),
    output:
        html="results/explorer.html",
    log:
        "results/logs/write_explorer.log",
    params:
        settings={},
        code=code_of("write_explorer", texts=templates("explorer.html", "explorer/*")),
    message:
        "Writing the explorer"
    run:
        run_step("write_explorer", wildcards, input, output, params, threads, log)


rule write_report:
    input:
        **inputs_of(REPORT_NEEDS),
        texts=[project(path) for path in REPORT_TEXTS],
        pictures=expand("results/figures/{name}.png", name=NEEDS),
        sources=[project(f"manuscript/{document}.md") for document in DOCUMENTS],
        claims="results/claims.json",
        findings="results/findings.json",
        figures=expand("results/figures/{name}.pdf", name=NEEDS),
        shipped=project("config/config.yaml"),
        citation=project("CITATION.cff"),
    output:
        html=expand("results/manuscript/{document}.html", document=DOCUMENTS),
        pdf=expand("results/manuscript/{document}.pdf", document=DOCUMENTS),
        verdicts="results/manuscript/verdicts.yaml",
    log:
        "results/logs/write_report.log",
    priority: 1
    params:
        settings={"figures": list(NEEDS), "config": config},
        code=code_of("write_report", texts=[*REPORT_TEXTS, *templates("report.*")]),
    message:
        "Writing the report"
    run:
        run_step("write_report", wildcards, input, output, params, threads, log)


rule write_scenes_page:
    input:
        pictures=expand("results/scenes/{scene}.png", scene=SCENES),
    output:
        html="results/scenes/index.html",
    log:
        "results/logs/write_scenes_page.log",
    params:
        settings={"scenes": TITLES},
        code=code_of("write_scenes_page", texts=templates("scenes.html")),
    message:
        "Writing the page of the scenes"
    run:
        run_step("write_scenes_page", wildcards, input, output, params, threads, log)


rule write_index:
    input:
        results=RESULTS,
        seconds=[*SECONDS.values()],
        captions=project("manuscript/captions.yaml"),
        summary=project("manuscript/summary.yaml"),
        errata=project("manuscript/errata.yaml"),
    output:
        html="results/index.html",
        provenance="results/provenance.json",
        checksums="results/checksums.txt",
        manifest="results/codecheck.yml",
    log:
        "results/logs/write_index.log",
    priority: 2
    params:
        settings={
            "config": config,
            "shipped": SHIPPED,
            "figures": [*NEEDS, *SWEEPS],
            "scenes": TITLES,
        },
        # The provenance contains a digest of all source files, and so each of them matters.
        code=code_of(
            "write_index",
            texts=[path.relative_to(PROJECT).as_posix() for path in source_files(PROJECT)],
        ),
    message:
        "Writing the page of all results"
    run:
        run_step("write_index", wildcards, input, output, params, threads, log)
