# Studies: one table each, of runs of their own, or of exact theory beside simulations.

from slippulse.steps.reach import sources


def kernels_for(study):
    """Only a study that reaches the solver waits for the kernels."""
    reached = any("solver" in Path(path).parts for path in sources(f"studies.{study}"))
    return {"kernels": "results/kernels.txt"} if reached else {}


for study in ALL_STUDIES:

    rule:
        name:
            f"study_of_{study}"
        input:
            **inputs_of(STUDY_NEEDS[study]),
            **kernels_for(study),
        output:
            table=f"results/studies/{study}.csv",
        log:
            f"results/logs/studies/{study}.log",
        priority: 1
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
