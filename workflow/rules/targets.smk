# Included last: checks the targets and their cost, and tells Snakemake which results are faulty.

import logging
import shlex

from snakemake.logging import logger

from slippulse.configuration.refusals import format_problems
from slippulse.data.files import write_json
from slippulse.data.tree import Tree
from slippulse.steps.origins import LOCK, jobs_of
from slippulse.steps.targets import Plan, unlike, write_faulty

GIVEN = {
    "--configfile": [*map(os.path.relpath, workflow.overwrite_configfiles)],
    "--config": workflow.config_settings.config_args,
}
OPTIONS = [word for key, values in GIVEN.items() if values for word in (key, *values)]
RULES = {rule.name: getattr(rules, rule.name) for rule in workflow.rules}
# Targets by name: rules without wildcards; `verify` looks at what a run makes by default.
NAMED = {
    name: rule.output or rule.input
    for name, rule in RULES.items()
    if "{" not in "".join(rule.output)
}
NAMED |= dict.fromkeys(("all", "verify"), EVERYTHING if ACCURACY.get("whole", True) else DRAFT)
MAKING = [
    (name, rule.input, rule.output, rule.params) for name, rule in RULES.items() if rule.output
]
MADE_BY = [job for rule in MAKING for job in jobs_of(*rule, VALUES)]
PLAN = Plan(MADE_BY, NAMED, shlex.join(OPTIONS))


def in_one_line(function):
    """Call a function; a refusal ends the run with its own words."""
    try:
        return function()
    except (ConfigError, OSError) as error:
        failed = isinstance(error, OSError)
        sys.exit(f"{error.filename}: {error.strerror}" if failed else str(error))


@cache
def begin():
    """Refuse what is asked for, or have faulty results found old. Returns the lock of the run."""
    return in_one_line(lambda: begin_with(sorted(workflow.dag_settings.targets) or ["all"]))


def begin_with(targets):
    """Check the targets and what they cost, and compare the results that they need."""
    wanted = PLAN.wanted(targets)
    if problem := unlike(LOCK):
        raise ConfigError(problem)
    if "verify" in targets:
        sys.exit(PLAN.verify(wanted))
    simulated = {
        Path(name).parts[1].removesuffix(".nc") for name in wanted if name.startswith("data/")
    }
    costs = [line for name in sorted(simulated) for line in settings_of(name)["cost"]()]
    if costs and not CONFIG.allow_large:
        raise ConfigError(format_problems(costs))
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
        kept = {**config, "preset": SHIPPED["preset"]}
        called["altered"] = bool(ALTERED and changes(SHIPPED, kept))
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
    how = ["--cores", str(workflow.cores)]
    if not workflow.local_exec:
        how = ["--executor", workflow.executor_plugin.name, "--jobs", str(workflow.nodes)]
    renewal = ["snakemake", *how, *OPTIONS, "--", "everything"]
    if "MAKELEVEL" in os.environ:
        renewal = ["make", "replicate", *given, "TARGET=everything"]
    write_faulty(Tree("results", PLAN.origins).outdated(), f". Renew them: {shlex.join(renewal)}")


if workflow.is_main_process:
    logger.addFilter(explain)
    in_one_line(lambda: PLAN.check_places(".snakemake", "results/logs"))
