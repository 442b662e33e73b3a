# Included last: what is asked for is known, affordable, and made from nothing that is not what its record says.

import shlex
import threading

from slippulse.configuration.refusals import format_problems
from slippulse.data.files import write_json
from slippulse.data.records import Tree
from slippulse.steps.reach import jobs_of
from slippulse.steps.targets import Plan, say_faulty

OPTIONS = (
    ["--configfile", *map(os.path.relpath, workflow.overwrite_configfiles)] if OVERLAYS else []
)
OPTIONS += ["--config", *CALLED.config] if CALLED.config else []
RULES = {rule.name: getattr(rules, rule.name) for rule in workflow.rules}
# What may be asked for by name: rules without wildcards, and to `verify` what a run without a name makes.
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
    """Before anything is planned: refuse, or remove what is to be made anew."""
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
    # `make verify` and the last line of a run ask for it.
    called = {"options": OPTIONS, "targets": targets, "page": "index.html" in wanted}
    write_json(called, "results/records/.call")
    return held


def look(faulty):
    """Say what would be removed; a dry run begins anew with these files forced, since they are still there."""
    if "SLIPPULSE_PLANNED" not in os.environ:
        say_faulty(faulty, "; would be removed, and made anew where needed.")
        if faulty and CALLED.dryrun:
            at = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
            forced = ["--forcerun", *(f"results/{name}" for name in faulty)]
            called = [sys.executable, "-m", "snakemake", *sys.argv[1:at], *forced, *sys.argv[at:]]
            os.execve(sys.executable, called, os.environ | {"SLIPPULSE_PLANNED": "yes"})


def end():
    """One line on results that this run has left behind, with the command that renews them."""
    given = [
        f"{name}={os.environ[name]}"
        for name in ("PRESET", "OVERLAY", "ALLOW_LARGE")
        if os.getenv(name)
    ]
    how = ["--profile", *CALLED.profile] if CALLED.profile else ["--cores", str(CALLED.cores or 1)]
    renewal = ["snakemake", *how, *OPTIONS, "--", "everything"]
    if "MAKELEVEL" in os.environ:
        renewal = ["make", "replicate", *given, "TARGET=everything"]
    say_faulty(Tree("results", PLAN.origins).outdated(), f". Renew them: {shlex.join(renewal)}")
    # Timers of Snakemake, which would look for jobs again: its process would last until each is due.
    for thread in threading.enumerate():
        if isinstance(thread, threading.Timer):
            thread.cancel()


try:
    LOCK = begin() if workflow.is_main_process else None
except (ConfigError, OSError) as error:
    sys.exit(f"{error.filename}: {error.strerror}" if isinstance(error, OSError) else str(error))
