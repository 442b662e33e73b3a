# Included last: checks the targets and their cost, and tells Snakemake which results are faulty.

import logging
import shlex
from contextlib import contextmanager
from itertools import chain

from snakemake.logging import logger

from slippulse_paper.configuration.refusals import format_problems
from slippulse_paper.records.job_records import write_json
from slippulse_paper.records.tree import Tree
from slippulse_paper.steps.origins import LOCK, jobs_of
from slippulse_paper.steps.targets import Plan, unlike, write_faulty

overlays, values = workflow.overwrite_configfiles, workflow.config_settings.config_args
OPTIONS = ["--configfile", *map(os.path.relpath, overlays)] if overlays else []
OPTIONS += ["--config", *values] if values else []
RULES = {rule.name: getattr(rules, rule.name) for rule in workflow.rules if rule.name != "step"}
# Targets by name: rules without wildcards; `verify` looks at what a run makes by default.
NAMED = {
    name: rule.output or rule.input
    for name, rule in RULES.items()
    if "{" not in "".join(rule.output)
}
NAMED |= dict.fromkeys(("all", "verify"), EVERYTHING if ACCURACY.get("whole", True) else DRAFT)
MADE_BY = [jobs_of(name, rule, VALUES) for name, rule in RULES.items() if rule.output]
PLAN = Plan([*chain.from_iterable(MADE_BY)], NAMED, shlex.join(OPTIONS))


@contextmanager
def in_one_line():
    """Let refusals end the run with their own words."""
    try:
        yield
    except ConfigError as error:
        sys.exit(str(error))
    except OSError as error:
        sys.exit(f"{error.filename}: {error.strerror}")


@cache
@in_one_line()
def begin():
    """Check targets and their cost, and have faulty results found old. Returns the run's lock."""
    targets = sorted(workflow.dag_settings.targets) or ["all"]
    wanted = PLAN.wanted(targets)
    if problem := unlike(LOCK):
        raise ConfigError(problem)
    if "verify" in targets:
        sys.exit(PLAN.verify(wanted))
    data = [Path(name).parts[1] for name in wanted if name.startswith("data/")]
    simulated = sorted({name.removesuffix(".nc") for name in data})
    costs = {CONFIG.key_of(name): settings_of(name)["exceeded"]() for name in simulated}
    lines = [f"{key}.{cost}" for key, cost in costs.items() if cost]
    if lines and not CONFIG.allow_large:
        raise ConfigError(format_problems(lines))
    # Without an executor Snakemake only looks, as for a graph.
    makes = workflow.executor_plugin and not (workflow.dryrun or workflow.touch)
    held = PLAN.begin(wanted, makes)
    for line in ALTERED.untaken() if ALTERED else ():
        print(line, file=sys.stderr)
    if makes:
        JOBS.begin()
        # `make verify` and the last line of a run read how the run was called.
        called = {"options": OPTIONS, "targets": targets, "page": "index.html" in wanted}
        called["judged"] = "claims.json" in wanted
        called["altered"] = changes(SHIPPED, {**config, "preset": SHIPPED["preset"]}) != []
        write_json(called, "results/records/.call")
    return held


# Text of Snakemake after the reasons of jobs that failed.
AFTERWARDS = ("Complete log", "Elapsed time", "At least one job did not complete")


def explain(record):
    """Say which target was meant; and leave the last word to a job that failed."""
    if FAILED and any(words in record.getMessage() for words in AFTERWARDS):
        return False
    if record.levelno >= logging.ERROR and workflow.dag_settings:
        try:
            PLAN.wanted(sorted(workflow.dag_settings.targets))
        except ConfigError as error:
            record.msg, record.args = str(error), ()
    return True


def end():
    """Write one line on results that this run leaves outdated, with the command to renew them."""
    names = [name for name in ("PRESET", "OVERLAY", "ALLOW_LARGE") if os.getenv(name)]
    given = [f"{name}={os.environ[name]}" for name in names]
    # Where jobs run elsewhere, the number of cores is not known.
    if workflow.local_exec:
        how = ["--cores", str(workflow.cores)]
    else:
        how = ["--executor", workflow.executor_plugin.name, "--jobs", str(workflow.nodes)]
    renewal = ["snakemake", *how, *OPTIONS, "--", "everything"]
    if "MAKELEVEL" in os.environ:
        renewal = ["make", "replicate", *given, "TARGET=everything"]
    write_faulty(Tree("results", PLAN.origins).outdated(), f". Renew them: {shlex.join(renewal)}")


if workflow.is_main_process:
    logger.addFilter(explain)
    with in_one_line():
        PLAN.check_places(".snakemake", "results/logs")
