# What the paper says, what was measured, how sure that is, and the verdict.


rule write_claims:
    input:
        CLAIM_SOURCES,
        measured=[f"results/measurements/{name}.csv" for name in CLAIM_SIMULATIONS],
        coarser=[f"results/uncertainties/coarser/{name}.csv" for name in CLAIM_SIMULATIONS],
        uncertainties=[f"results/uncertainties/{name}.csv" for name in CLAIM_SIMULATIONS],
    output:
        json="results/claims.json",
        html=report(
            "results/claims.html",
            category="Claims",
            labels={"table": "claims"},
        ),
    log:
        "results/logs/write_claims.log",
    benchmark:
        "results/benchmarks/write_claims.tsv"
    params:
        settings={key: config[key] for key in ("claims", "published", "measure")},
    message:
        "Judging the claims"
    script:
        "../scripts/write_claims.py"
