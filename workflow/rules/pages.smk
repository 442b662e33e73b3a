# What is read: claims, explorer, report, what the results were made from, and the page that leads to it all.

from slippulse.data.alterations import changes
from slippulse.data.provenance import source_files

CLAIM_SIMULATIONS = declared("claims.paper", "SIMULATIONS")
CLAIM_STUDIES = "derivations open_choices published_figure published_scheme rate_dependence".split()
DOCUMENTS = declared("report.manuscript", "DOCUMENTS")
STUDIED = sorted({*CLAIM_SIMULATIONS, *OWN_SIMULATIONS, *SCENES})
MEASURED = sorted({*simulations_of(*NEEDS.values()), *STUDIED})
OWN_SWEEPS = made("figures", SWEEP_NEEDS)
RESULTS = [
    # The claims first, so that they come first in Snakemake's own report too.
    *expand("results/{name}", name=("claims.html", "claims.json", "findings.json", "explorer.html")),
    *made("figures", NEEDS),
    *made("data", MEASURED),
    *made("measured", MEASURED),
    *made("uncertainties", STUDIED),
    *made("studies", CONFIG.studies or STUDY_NEEDS),
    *made("scenes", SCENES),
    *OWN_SWEEPS,
    *expand("results/manuscript/{document}.{ending}", document=DOCUMENTS, ending=("html", "pdf")),
]
EVERYTHING = [*RESULTS, "results/provenance.json", "results/index.html"]
WHOLE = ACCURACY.get("whole", True)
# What a draft makes unless everything is asked for: the figures of the paper with what they are drawn from, and what
# an overlay adds.
FIRST = [
    *made("figures", FIGURES),
    *made("data", sorted(simulations_of(*(NEEDS[figure] for figure in FIGURES)))),
    *made("measured", [name for figure in FIGURES for name in NEEDS[figure].get("measured", [])]),
    *made("measured", OWN_SIMULATIONS),
    *made("scenes", OWN_SCENES),
    *OWN_SWEEPS,
]
TEXTS = ("captions", "claims", "errata", "metadata", "shipped_verdicts", "statements", "summary")
TITLES = {name: scene["title"] for name, scene in SCENES.items()}
GALLERIES = {
    "The figures of the paper": FIGURES,
    "Beyond the paper": [name for name in NEEDS if name not in FIGURES],
    "User-defined sweeps": [*SWEEP_NEEDS],
}


rule write_claims:
    input:
        # Of front speeds at one level, without a grid study.
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
        html=report("results/claims.html", category="Claims", labels={"table": "claims"}),
    priority: 2
    params:
        claims=config["claims"],
        published=config["published"],
        measure=config["measure"],
        damping_ratio=config["model"]["damping_ratio"],
        altered=changes(SHIPPED, config),
    message:
        "Judging the claims"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule write_explorer:
    input:
        law="results/studies/explorer_law.csv",
        measured=made("measured", declared("steps.write_explorer", "SIMULATIONS")),
    output:
        html="results/explorer.html",
    message:
        "Writing results/explorer.html"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule write_report:
    input:
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
    params:
        figures=list(NEEDS),
        config=config,
    message:
        "Writing the replication report"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule write_scenes_page:
    input:
        expand("results/scenes/{scene}.png", scene=SCENES),
    output:
        html="results/scenes/index.html",
    params:
        scenes=TITLES,
    message:
        "Writing the list of scenes"
    run:
        run_step(rule, wildcards, input, output, params, threads)


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
    params:
        config=config,
        shipped=SHIPPED,
    message:
        "Noting what the results were made from"
    run:
        run_step(rule, wildcards, input, output, params, threads)


rule write_index:
    input:
        captions="manuscript/captions.yaml",
        summary="manuscript/summary.yaml",
        # All else that it shows, or leads to, comes before this.
        provenance="results/provenance.json",
        ledger=["results/claims.json", "results/findings.json"],
        pictures=made("figures", NEEDS) + OWN_SWEEPS,
    output:
        html="results/index.html",
    params:
        galleries={heading: names for heading, names in GALLERIES.items() if names},
        scenes=TITLES,
    message:
        "Writing results/index.html, the page to open"
    run:
        run_step(rule, wildcards, input, output, params, threads)
