# The replication report: text with expressions, executed over the ledger and rendered as one HTML file and a PDF.


rule write_report:
    input:
        REPORT_SOURCES,
        LOCK,
        source="manuscript/replication.md",
        claims="results/claims.json",
        measured=[f"results/measurements/{name}.csv" for name in REPORT_SIMULATIONS],
        uncertainties=[f"results/uncertainties/{name}.csv" for name in REPORT_SIMULATIONS],
        figures=[f"results/figures/{name}.pdf" for name in REPORT_FIGURES],
        pictures=[f"results/figures/{name}.png" for name in REPORT_FIGURES],
        shipped="config/config.yaml",
    output:
        html="results/manuscript/replication.html",
        pdf="results/manuscript/replication.pdf",
        verdicts="results/manuscript/verdicts.yaml",
    log:
        "results/logs/write_report.log",
    benchmark:
        "results/benchmarks/write_report.tsv"
    params:
        figures=REPORT_FIGURES,
        settings=dict(config),
    message:
        "Writing the replication report"
    script:
        "../scripts/write_report.py"
