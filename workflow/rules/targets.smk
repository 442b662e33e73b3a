# Included last: checks the targets and their cost, and removes results that are faulty.

import shlex
import threading

from slippulse.configuration.refusals import format_problems
from slippulse.data.files import write_json
from slippulse.data.tree import Tree
from slippulse.steps.origins import jobs_of
from slippulse.steps.targets import Plan, write_faulty

OPTIONS = ["--config", *CALLED.config] if CALLED.config else []
if OVERLAYS:
    OPTIONS = ["--configfile", *map(os.path.relpath, workflow.overwrite_configfiles), *OPTIONS]
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
PLAN = Plan([job for rule in MAKING for job in jobs_of(*rule, VALUES)], NAMED)


def begin():
    """Refuse the run, or remove what it is to make anew, before Snakemake plans it."""
    targets = sorted(CALLED.targets) or ["all"]
    wanted = PLAN.wanted(targets)
    if "verify" in targets:
        sys.exit(PLAN.verify(wanted))
    PLAN.check_places(".snakemake", "results/logs")
    simulated = {
        Path(name).parts[1].removesuffix(".nc") for name in wanted if name.startswith("data/")
    }
    costs = [line for name in sorted(simulated) for line in settings_of(name)["cost"]()]
    if costs and not CONFIG.allow_large:
        raise ConfigError(format_problems(costs))
    if LOOKS:
        return look(PLAN.tree.to_remove(wanted))
    held = PLAN.begin(wanted, Path(".snakemake"))
    # `make verify` and the last line of a run read how the run was called.
    called = {"options": OPTIONS, "targets": targets, "page": "index.html" in wanted}
    write_json(called, "results/records/.call")
    return held


def look(faulty):
    """Write what a run would remove; a dry run starts again with these files forced."""
    if "SLIPPULSE_PLANNED" not in os.environ:
        write_faulty(faulty, "; would be removed, and made anew where needed.")
        if faulty and CALLED.dryrun:
            end = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
            forced = ["--forcerun", *(f"results/{name}" for name in faulty)]
            called = [sys.executable, "-m", "snakemake", *sys.argv[1:end], *forced, *sys.argv[end:]]
            os.execve(sys.executable, called, os.environ | {"SLIPPULSE_PLANNED": "yes"})


def end():
    """Write one line on results that this run leaves outdated, with the command to renew them."""
    names = [name for name in ("PRESET", "OVERLAY", "ALLOW_LARGE") if os.getenv(name)]
    given = [f"{name}={os.environ[name]}" for name in names]
    how = ["--profile", *CALLED.profile] if CALLED.profile else ["--cores", str(CALLED.cores or 1)]
    renewal = ["snakemake", *how, *OPTIONS, "--", "everything"]
    if "MAKELEVEL" in os.environ:
        renewal = ["make", "replicate", *given, "TARGET=everything"]
    write_faulty(Tree("results", PLAN.origins).outdated(), f". Renew them: {shlex.join(renewal)}")
    # Snakemake's timers, which look for jobs, would keep its process until each is due.
    for thread in threading.enumerate():
        if isinstance(thread, threading.Timer):
            thread.cancel()


try:
    LOCK = begin() if workflow.is_main_process else None
except (ConfigError, OSError) as error:
    sys.exit(f"{error.filename}: {error.strerror}" if isinstance(error, OSError) else str(error))
