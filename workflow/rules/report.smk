# The replication report and its supplement: texts with expressions, executed over the ledger, each as HTML and PDF.

DOCUMENTS = declared("report.manuscript", "DOCUMENTS")


rule write_report:
    input:
        [
            f"manuscript/{name}"
            for name in (
                "captions.yaml",
                "claims.yaml",
                "errata.yaml",
                "metadata.yaml",
                "references.bib",
                "shipped_verdicts.yaml",
                "statements.yaml",
                "summary.yaml",
            )
        ],
        **inputs_of(declared("steps.write_report", "NEEDS")),
        sources=expand("manuscript/{document}.md", document=DOCUMENTS),
        claims="results/claims.json",
        findings="results/findings.json",
        figures=[f"results/figures/{name}.pdf" for name in NEEDS],
        pictures=[f"results/figures/{name}.png" for name in NEEDS],
        shipped="config/config.yaml",
        citation="CITATION.cff",
    output:
        html=expand("results/manuscript/{document}.html", document=DOCUMENTS),
        pdf=expand("results/manuscript/{document}.pdf", document=DOCUMENTS),
        verdicts="results/manuscript/verdicts.yaml",
    log:
        "results/logs/write_report.log",
    params:
        figures=list(NEEDS),
        config=config,
    message:
        "Writing the replication report"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)
