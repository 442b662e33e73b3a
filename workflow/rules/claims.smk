# What the paper says, what was measured, how sure that is, and the verdict.

if config["claims"]:
    from slippulse.claims.entries import read_entries

    try:
        read_entries("manuscript/claims.yaml", config["claims"])
    except ValueError as error:
        refuse(f"The configuration is refused:\n{error}")


rule write_claims:
    input:
        # Of front speeds at one level, without a grid study.
        measured=tables("measurements", [*CLAIM_SIMULATIONS, "front_speed"]),
        coarser=tables("uncertainties/coarser", CLAIM_SIMULATIONS),
        uncertainties=tables("uncertainties", CLAIM_SIMULATIONS),
        predicted=tables("predictions", declared("claims.paper", "PREDICTED")),
        studies=tables(
            "studies",
            ["derivations", "open_choices", "published_figure", "published_scheme", "rate_dependence"],
        ),
        texts="manuscript/claims.yaml",
        statements="manuscript/statements.yaml",
    output:
        json="results/claims.json",
        findings="results/findings.json",
        html=report("results/claims.html", category="Claims", labels={"table": "claims"}),
    log:
        "results/logs/write_claims.log",
    priority: 1
    params:
        claims=config["claims"],
        published=config["published"],
        measure=config["measure"],
        damping_ratio=config["model"]["damping_ratio"],
        altered=changes(SHIPPED, config),
    message:
        "Judging the claims"
    run:
        run_step(rule, wildcards, input, output, params, threads, log)
