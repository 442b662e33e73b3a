# The replication report: text with expressions, executed over the ledger and rendered as one HTML file and a PDF.


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
            )
        ],
        **inputs_of(declared("steps.write_report", "NEEDS")),
        source="manuscript/replication.md",
        claims="results/claims.json",
        findings="results/findings.json",
        figures=[f"results/figures/{name}.pdf" for name in NEEDS],
        pictures=[f"results/figures/{name}.png" for name in NEEDS],
        shipped="config/config.yaml",
    output:
        html="results/manuscript/replication.html",
        pdf="results/manuscript/replication.pdf",
        verdicts="results/manuscript/verdicts.yaml",
    log:
        "results/logs/write_report.log",
    params:
        step="write_report",
        figures=list(NEEDS),
        config=plain(config),
    message:
        "Writing the replication report"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)
