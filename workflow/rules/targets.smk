# Included last: what is asked for is known, affordable, and made from nothing that is not what its record says.

import shlex
import threading
from types import SimpleNamespace

from snakemake.cli import get_argument_parser

from slippulse.configuration.read import format_problems
from slippulse.data.files import write_json
from slippulse.steps.reach import Job
from slippulse.steps.targets import Plan, say_faulty

CALLED = get_argument_parser().parse_known_args(sys.argv[1:])[0]
# With these Snakemake only looks.
LOOKS = (
    "archive cleanup_metadata containerize dag d3dag detailed_summary dryrun export_cwl filegraph generate_unit_tests lint"
    " list_changes list_input_changes list_params_changes list_rules list_target_rules list_untracked print_compilation"
    " report rulegraph summary touch unlock"
)
OPTIONS = ["--configfile", *map(os.path.relpath, workflow.overwrite_configfiles)] if OVERLAYS else []
OPTIONS += ["--config", *CALLED.config] if CALLED.config else []
RULES = {rule.name: getattr(rules, rule.name) for rule in workflow.rules}


def jobs_of(name, rule):
    """The jobs that a rule stands for, one for each value of its wildcard."""
    wildcard = next((key for key in VALUES if f"{{{key}}}" in rule.output[0]), "none")
    for value in VALUES.get(wildcard, [""]):
        known = {wildcard: value}

        def filled(entry):
            return entry(SimpleNamespace(**known)) if callable(entry) else entry

        def files(entries):
            several = (filled(entry) if callable(entry) else [entry] for entry in entries)
            return tuple(path.format(**known) for paths in several for path in paths)

        settings = {key: filled(entry) for key, entry in rule.params.items()}
        # A rule without another step has that of its own name.
        yield Job(settings.pop("step", name), files(rule.input), files(rule.output), settings)


# What may be asked for by name: rules without wildcards; `verify` compares what they make.
NAMED = {name: rule.output or rule.input for name, rule in RULES.items() if "{" not in "".join(rule.output)}
JOBS_OF_RULES = [job for name, rule in RULES.items() if rule.output for job in jobs_of(name, rule)]
PLAN = Plan(JOBS_OF_RULES, NAMED | {"verify": NAMED["all"]})


def begin():
    """Before anything is planned: refuse, or remove what is to be made anew."""
    targets = sorted(CALLED.targets) or ["all"]
    wanted = PLAN.wanted(targets)
    if "verify" in targets:
        sys.exit(PLAN.verify(wanted))
    PLAN.check_places(".snakemake", "results/logs")
    simulated = {Path(name).parts[1].removesuffix(".nc") for name in wanted if name.startswith("data/")}
    costs = {settings_of(name)["cost"] for name in simulated} - {""}
    if costs and not CONFIG.allow_large:
        raise ConfigError(format_problems(sorted(costs)))
    if any(getattr(CALLED, option) for option in LOOKS.split()):
        return look(PLAN.tree.to_remove(wanted))
    held = PLAN.begin(wanted, Path(".snakemake"))
    if not all(Path("results", name).exists() for name in wanted):
        JOBS.begin()
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
    given = [f"{name}={os.environ[name]}" for name in ("PRESET", "OVERLAY", "ALLOW_LARGE") if os.getenv(name)]
    renewal = ["snakemake", "--cores", str(workflow.cores), *OPTIONS, "--", "everything"]
    if "MAKELEVEL" in os.environ:
        renewal = ["make", "replicate", *given, "TARGET=everything"]
    say_faulty(PLAN.left_behind(), f". Renew them: {shlex.join(renewal)}")
    # Timers of Snakemake, which would look for jobs again: its process would last until each is due.
    for thread in threading.enumerate():
        if isinstance(thread, threading.Timer):
            thread.cancel()


try:
    LOCK = begin() if workflow.is_main_process else None
except (ConfigError, OSError) as error:
    sys.exit(f"{error.filename}: {error.strerror}" if isinstance(error, OSError) else str(error))
