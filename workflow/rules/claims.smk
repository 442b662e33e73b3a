# What the paper says, what was measured, how sure that is, and the verdict.


rule write_claims:
    input:
        sources("steps.write_claims"),
        measured=tables("measurements", CLAIM_SIMULATIONS),
        coarser=tables("uncertainties/coarser", CLAIM_SIMULATIONS),
        uncertainties=tables("uncertainties", CLAIM_SIMULATIONS),
    output:
        json="results/claims.json",
        html=report("results/claims.html", category="Claims", labels={"table": "claims"}),
    log:
        "results/logs/write_claims.log",
    benchmark:
        "results/benchmarks/write_claims.tsv"
    params:
        step="write_claims",
        claims=plain(config["claims"]),
        published=plain(config["published"]),
        share=config["measure"]["share"],
        configuration=configuration(
            CLAIM_SIMULATIONS,
            measure=config["measure"],
            coarser=ACCURACY["coarser"],
            claims=config["claims"],
            published=config["published"],
        ),
    message:
        "Judging the claims"
    script:
        "../scripts/step.py"
