# Files to read: claims, explorer, report, and the page that leads to all, with the provenance.

from slippulse_paper.records.provenance import changes, source_files

CLAIM_STUDIES = (
    "derivations friction_laws layer open_choices published_figure published_scheme rate_dependence"
).split()
DOCUMENTS = declared("report.manuscript", "DOCUMENTS")
RESULTS = [
    # The claims are first here, and so in Snakemake's report.
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
EVERYTHING = [*RESULTS, "results/provenance.json", "results/index.html"]
# By default, a draft makes the figures of the paper and what an overlay adds.
DRAFT = made("figures", [*FIGURES, *SWEEPS]) + made("measured", OWN_SIMULATIONS)
DRAFT += made("scenes", [name for name in SCENES if name not in SHIPPED.get("scenes", {})])
TEXTS = ("captions", "claims", "errata", "metadata", "shipped_verdicts", "statements", "summary")


use rule step as write_claims with:
    input:
        environment,
        measured=made("measured", [*CLAIM_SIMULATIONS, "front_speed"]),
        coarser=made("coarser", CLAIM_SIMULATIONS),
        uncertainties=made("uncertainties", CLAIM_SIMULATIONS),
        predicted=made("predicted", CLAIM_PREDICTED),
        studies=made("studies", CLAIM_STUDIES),
        texts="manuscript/claims.yaml",
        statements="manuscript/statements.yaml",
    output:
        json="results/claims.json",
        findings="results/findings.json",
        html=report("results/claims.html", category="Claims"),
    log:
        "results/logs/write_claims.log",
    params:
        **{key: config[key] for key in ("claims", "published", "measure")},
        damping_ratio=config["model"]["damping_ratio"],
        altered=changes(SHIPPED, config),


use rule step as write_explorer with:
    input:
        environment,
        law="results/studies/explorer_law.csv",
        measured=made("measured", declared("steps.write_explorer", "SIMULATIONS")),
    output:
        html="results/explorer.html",
    log:
        "results/logs/write_explorer.log",
    priority: 0


use rule step as write_report with:
    input:
        environment,
        "manuscript/references.bib",
        expand("manuscript/{text}.yaml", text=TEXTS),
        expand("results/figures/{name}.png", name=NEEDS),
        **inputs_of(REPORT_NEEDS),
        sources=expand("manuscript/{document}.md", document=DOCUMENTS),
        claims="results/claims.json",
        findings="results/findings.json",
        figures=expand("results/figures/{name}.pdf", name=NEEDS),
        shipped="config/config.yaml",
        citation="CITATION.cff",
    output:
        html=expand("results/manuscript/{document}.html", document=DOCUMENTS),
        pdf=expand("results/manuscript/{document}.pdf", document=DOCUMENTS),
        verdicts="results/manuscript/verdicts.yaml",
    log:
        "results/logs/write_report.log",
    priority: 1
    params:
        figures=list(NEEDS),
        config=config,


use rule step as write_scenes_page with:
    input:
        environment,
        expand("results/scenes/{scene}.png", scene=SCENES),
    output:
        html="results/scenes/index.html",
    log:
        "results/logs/write_scenes_page.log",
    priority: 0
    params:
        scenes=TITLES,


use rule step as write_index with:
    input:
        environment,
        [path.as_posix() for path in source_files(".")],
        results=RESULTS,
        captions="manuscript/captions.yaml",
        summary="manuscript/summary.yaml",
        errata="manuscript/errata.yaml",
    output:
        html="results/index.html",
        provenance="results/provenance.json",
        checksums="results/checksums.txt",
        manifest="results/codecheck.yml",
    log:
        "results/logs/write_index.log",
    params:
        config=config,
        shipped=SHIPPED,
        figures=[*NEEDS, *SWEEPS],
        scenes=TITLES,


GATHERED = {
    "everything": EVERYTHING,
    "scenes": [*made("scenes", SCENES), *made("animations", SCENES), "results/scenes/index.html"],
    **{figure.partition("_")[0]: made("figures", [figure]) for figure in FIGURES},
}
for name, files in GATHERED.items():

    rule:
        name:
            name
        input:
            files,
