# Studies of the solver itself: one table each, from runs of their own.

for study in SOLVER_STUDIES:

    rule:
        name:
            f"study_of_{study}"
        input:
            sources("steps.run_study", f"studies.{study}"),
            LOCK,
            kernels="results/kernels.txt",
        output:
            table=f"results/studies/{study}.csv",
        log:
            f"results/logs/studies/{study}.log",
        resources:
            runtime=20,
        params:
            step="run_study",
            module=f"studies.{study}",
            values=settings_of_study(study),
            configuration=configuration(study=settings_of_study(study)),
        message:
            f"Studying {study}"
        run:
            run_step(rule, wildcards, input, output, params, threads, log)
