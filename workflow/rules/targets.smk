# Included last: what is asked for is something that a rule makes, is affordable, and is made from nothing that is not
# what its record says.

import json
import shlex
import threading
import time
from contextlib import suppress
from types import SimpleNamespace

from snakemake.cli import get_argument_parser
from snakemake.logging import logger

from slippulse.configuration.read import format_problems
from slippulse.data.files import write_json
from slippulse.data.lock import take
from slippulse.data.records import Tree, record_path
from slippulse.steps.reach import Job, is_result, origins_of
from slippulse.steps.targets import check_places, check_targets

# How this run was called, which `make verify` and the last line of a run ask for.
CALL = "records/.call"
CALLED = get_argument_parser().parse_known_args(sys.argv[1:])[0]
# With these Snakemake only looks.
LOOKS = (
    "archive cleanup_metadata containerize dag d3dag detailed_summary dryrun export_cwl filegraph generate_unit_tests lint"
    " list_changes list_input_changes list_params_changes list_rules list_target_rules list_untracked print_compilation"
    " report rulegraph summary touch unlock"
)
LOOKING = any(getattr(CALLED, option) for option in LOOKS.split())
OPTIONS = [
    *(["--configfile", *map(os.path.relpath, workflow.overwrite_configfiles)] if OVERLAYS else []),
    *(["--config", *CALLED.config] if CALLED.config else []),
]
RULES = {rule.name: getattr(rules, rule.name) for rule in workflow.rules}


def jobs_of(name, rule):
    """The jobs that a rule stands for, one for each value of its wildcard."""
    wildcard = next((key for key in VALUES if f"{{{key}}}" in rule.output[0]), None)
    for value in VALUES.get(wildcard, [""]):
        wildcards = SimpleNamespace(**{wildcard: value} if wildcard else {})

        def filled(items):
            for item in items:
                found = item(wildcards) if callable(item) else item
                for path in [found] if isinstance(found, str) else found:
                    yield str(path).format(**vars(wildcards))

        settings = {key: entry(wildcards) if callable(entry) else entry for key, entry in rule.params.items()}
        # A rule without another step has that of its own name.
        yield Job(settings.pop("step", name), tuple(filled(rule.input)), tuple(filled(rule.output)), settings)


ALL_JOBS = [job for name, rule in RULES.items() if rule.output for job in jobs_of(name, rule)]
ORIGINS = origins_of(ALL_JOBS)
MADE = [f"results/{name}" for name in ORIGINS]


def files_of(*targets):
    """What is made for some targets, below results/: files, or all of a rule."""
    found = []
    for target in targets:
        files = RULES[target].output or RULES[target].input if target in RULES else [target]
        found += [below(file) for file in files if is_result(file)]
    return found


def refuse_targets(targets):
    """A misspelt target is refused with the nearest one that there is, and a place for results that is taken."""
    single = [name for name, rule in RULES.items() if not rule.output or "{" not in rule.output[0]]
    check_targets(targets, [*single, *MADE])
    files = [*MADE, *(f"results/{record_path(origin.record)}" for origin in ORIGINS.values())]
    folders = {parent for file in files for parent in Path(file).parents[:-1]}
    check_places([Path(".snakemake"), Path("results/logs"), *sorted(folders)], map(Path, files))


def refuse_expensive(wanted):
    """What is asked for takes no more than is allowed, unless it was asked for twice."""
    names = sorted({Path(file).parts[1].removesuffix(".nc") for file in wanted if file.startswith("data/")})
    bounds = {name: bound_of_job(name).exceeded(SIMULATIONS[name].chunks) for name in names}
    if problems := [
        f"{'scenes' if name in SCENES else 'simulations'}.{name}.{reason}"
        for name, reason in bounds.items()
        if reason
    ]:
        raise ConfigError(format_problems(problems))


def lock_folder():
    """One run at a time; what a killed one has left of Snakemake's own lock is removed."""
    held = take(".snakemake/run.lock")
    if held is None:
        refuse("Another run is at work in this folder: wait for it, or stop it.")
    stale = [lock for lock in Path(".snakemake/locks").glob("*") if lock.is_file()]
    # Files that a killed job was writing have a hidden name of their own until they are whole.
    for path in [*stale, *(Path("results").rglob(".*-????????.*") if stale else ())]:
        path.unlink(missing_ok=True)
    if stale:
        print("The last run was killed: what it left unfinished is made anew.", file=sys.stderr)
    return held


def say_faulty(reasons, fate):
    """One line on results that are not as made by what is here now, with the first reason that is not another's."""
    if reasons:
        first = next((name for name, reason in reasons.items() if "older than" not in reason), [*reasons][0])
        text = f"{len(reasons)} results are not as made by what is here now, as results/{first}: {reasons[first]}"
        print(f"{text}{fate}", file=sys.stderr)


def settle_times(wanted):
    """Let no wanted result be older than what it is made from, for which Snakemake would make it anew, nor later than now."""
    made, now = {f"results/{name}" for name in wanted}, time.time()
    jobs = [job for job in ALL_JOBS if job.outputs[0] in made]
    paths = {path for job in jobs for path in (*job.inputs, *job.outputs) if os.path.isfile(path)}
    times = {path: os.path.getmtime(path) for path in paths}
    late = sorted(path for path in times if times[path] > now)
    if late:
        print(f"{len(late)} files have a time in the future, as {late[0]}: set to now.", file=sys.stderr)
    if late or any(
        times.get(path, 0.0) > min(times.get(output, now) for output in job.outputs)
        for job in jobs
        for path in job.inputs
    ):
        for path in {*late, *(paths & made)}:
            with suppress(OSError):
                os.utime(path, (now, now))


def plan(faulty):
    """Say what would be removed; a dry run begins anew with these files forced, since they are still there."""
    if "SLIPPULSE_PLANNED" not in os.environ:
        say_faulty(faulty, "; would be removed, and made anew where needed.")
        if faulty and CALLED.dryrun:
            at = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
            forced = ["--forcerun", *(f"results/{name}" for name in faulty)]
            called = [sys.executable, "-m", "snakemake", *sys.argv[1:at], *forced, *sys.argv[at:]]
            os.execve(sys.executable, called, os.environ | {"SLIPPULSE_PLANNED": "yes"})


def renewal():
    """The command that makes everything as this run was called."""
    if "MAKELEVEL" not in os.environ:
        return shlex.join(["snakemake", "--cores", str(workflow.cores), *OPTIONS, "--", "everything"])
    given = [
        f"{name}={os.environ[name]}" for name in ("PRESET", "OVERLAY", "ALLOW_LARGE") if os.environ.get(name)
    ]
    return shlex.join(["make", "replicate", *given, "TARGET=everything"])


def end():
    """One line on results that this run has left behind, with the command that renews them."""
    tree = Tree("results", ORIGINS)
    left = {name: tree.outdated(name) for name in ORIGINS if Path("results", name).is_file()}
    say_faulty({name: left[name] for name in reversed(left) if left[name]}, f". Renew them: {renewal()}")
    # Timers of Snakemake, which would look for jobs again: its process would last until each is due.
    for thread in threading.enumerate():
        if isinstance(thread, threading.Timer):
            thread.cancel()


def verify(complete):
    """Compare all results with what a complete run would make; ends the process."""
    tree = Tree("results", ORIGINS)
    problems, count = tree.problems(complete)
    print("\n".join(problems) or f"{count} files are as made by what is here now")
    whole = tree.behind(files_of("everything"))
    if skipped := [name for name in whole if not Path("results", name).exists() and name not in complete]:
        print(f"Not looked at: {len(skipped)} files that TARGET=everything makes besides, as {skipped[0]}")
    raise SystemExit(1 if problems else 0)


def heard(record):
    """Of what Snakemake logs: without a bar on a terminal one line a job; not that it has finished when it has failed."""
    if getattr(record, "done", None) and not sys.stderr.isatty():
        print(f"{record.done} of {record.total}", file=sys.stderr)
    return "Complete log" not in str(record.msg)


logger.addFilter(heard)


def begin():
    """Before anything is planned: refuse, or remove what is to be made anew."""
    targets, tree = sorted(CALLED.targets) or ["all"], Tree("results", ORIGINS)
    if "verify" in targets:
        verify(tree.behind(files_of("all", *({"everything"} & {*targets}))))
    refuse_targets(CALLED.targets)
    wanted = tree.behind(files_of(*targets))
    if not CONFIG.allow_large:
        refuse_expensive(wanted)
    if LOOKING:
        return plan(tree.to_remove(wanted))
    held, faulty = lock_folder(), tree.to_remove(wanted)
    say_faulty(faulty, "; removed, and made anew where needed.")
    for name in faulty:
        Path("results", name).unlink()
    settle_times(wanted)
    if not all(Path("results", name).exists() for name in wanted):
        JOBS.begin()
    called = {"options": OPTIONS, "targets": targets, "page": "index.html" in wanted}
    write_json(called, Path("results", CALL))
    return held


try:
    if workflow.is_main_process:
        LOCK = begin()
except ConfigError as error:
    refuse(str(error))
except OSError as error:
    refuse(f"{error.filename}: {error.strerror}")
