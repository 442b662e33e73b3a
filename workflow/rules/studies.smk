# Studies: one table each, of runs of their own, or of exact theory beside simulations.

for study in ALL_STUDIES:

    rule:
        name:
            f"study_of_{study}"
        input:
            **inputs_of(STUDY_NEEDS[study]),
            kernels="results/kernels.txt",
        output:
            table=f"results/studies/{study}.csv",
        log:
            f"results/logs/studies/{study}.log",
        resources:
            runtime=20,
        params:
            step="run_study",
            study=study,
            values=settings_of_study(study),
        message:
            f"Studying {study}"
        run:
            run_step(rule, wildcards, input, output, params, threads, log)
