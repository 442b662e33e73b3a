# Included last: what is asked for is something that a rule makes, is affordable, and is made from nothing that is not
# what its record says.

import json
import math
import shlex
import threading
import time
from contextlib import suppress
from types import SimpleNamespace

from snakemake.cli import get_argument_parser
from snakemake.logging import logger

from slippulse.configuration.problems import format_problems
from slippulse.data.files import write_text
from slippulse.data.lock import take
from slippulse.data.records import Tree, record_path
from slippulse.data.verify import problems_of
from slippulse.steps.origins import Job, is_result, origins_of
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
# One a step, a figure and a study, and those that name what to make.
NAMES = [
    *("all", "everything", "scenes"),
    *NEEDS,
    *(figure.partition("_")[0] for figure in FIGURES),
    *(f"study_of_{name}" for name in ALL_STUDIES),
    *(path.stem for path in sorted((PACKAGE / "steps").glob("*.py"))),
]
RULES = {name: getattr(rules, name) for name in NAMES if rules.has(name)}


def jobs_of(name, rule):
    """The jobs that a rule stands for, one for each value of its wildcard."""
    wildcard = next((key for key in VALUES if f"{{{key}}}" in rule.output[0]), None)
    for value in VALUES[wildcard] if wildcard else [""]:
        values = {wildcard: value} if wildcard else {}
        wildcards = SimpleNamespace(**values)

        def filled(item):
            found = item(wildcards) if callable(item) else item
            return [str(path).format(**values) for path in ([found] if isinstance(found, str) else found)]

        settings = {key: entry(wildcards) if callable(entry) else entry for key, entry in rule.params.items()}
        inputs, outputs = (
            tuple(path for item in items for path in filled(item)) for items in (rule.input, rule.output)
        )
        # A rule without another step has that of its own name.
        yield Job(settings.pop("step", name), inputs, outputs, settings)


ALL_JOBS = [job for name, rule in RULES.items() if rule.output for job in jobs_of(name, rule)]
ORIGINS = origins_of(ALL_JOBS)
MADE = [f"results/{name}" for name in ORIGINS]


def files_of(target):
    """What is made for a target, below results/: a file, or all of a rule."""
    files = [target]
    if target in RULES:
        files = RULES[target].output or RULES[target].input
    return [below(file) for file in files if is_result(file)]


def refuse_places():
    """Where a folder or a file goes there is nothing of the other kind, and it may be written."""
    records = [f"results/{record_path(origin.record)}" for origin in ORIGINS.values()]
    logs = [rule.log[0] for rule in RULES.values() if rule.log]
    folders = {parent for file in [*MADE, *records, *logs] for parent in Path(file).parents[:-1]}
    check_places(Path("results"), [Path(".snakemake"), *sorted(folders)], map(Path, [*MADE, *records]))


def refuse_unknown_targets():
    """A misspelt target is refused with the nearest one that there is."""
    patterns = {name: rule.output[0] for name, rule in RULES.items() if rule.output and "{" in rule.output[0]}
    check_targets(CALLED.targets, [*RULES, *MADE, "verify"], patterns)


def refuse_expensive_targets(wanted):
    """What is asked for takes no more than is allowed, unless it was asked for twice."""
    names = sorted({Path(file).parts[1].removesuffix(".nc") for file in wanted if file.startswith("data/")})
    problems = []
    for name in names if not CONFIG.allow_large else ():
        if reason := bound_of_job(name).exceeded(SIMULATIONS[name].chunks):
            problems.append(f"{'scenes' if name in SCENES else 'simulations'}.{name}.{reason}")
    if problems:
        raise ConfigError(format_problems(problems))


def lock_folder():
    """One run at a time; what a killed one has left of Snakemake's own lock is removed."""
    held = take(".snakemake/run.lock")
    if held is None:
        refuse("Another run is at work in this folder: wait for it, or stop it.")
    stale = [lock for lock in Path(".snakemake/locks").glob("*") if lock.is_file()]
    for lock in stale:
        lock.unlink()
    if stale:
        # Files that a killed job was writing have a hidden name of their own until they are whole.
        for part in Path("results").rglob(".*-????????.*"):
            part.unlink(missing_ok=True)
        print("The last run was killed: what it left unfinished is made anew.", file=sys.stderr)
    return held


def say_faulty(faulty):
    """One line on what is not what its record says, with the first reason that is not another's."""
    if faulty:
        first = next((name for name, reason in faulty.items() if "older than" not in reason), [*faulty][0])
        fate = "would be removed" if LOOKING else "removed"
        print(
            f"{len(faulty)} results are not as made by what is here now, as results/{first}: {faulty[first]};"
            f" {fate}, and made anew where needed.",
            file=sys.stderr,
        )


def settle_times(wanted):
    """Let no wanted result be older than what it is made from, for which Snakemake would make it anew, nor later than now."""
    made = {f"results/{name}" for name in wanted}
    jobs = [job for job in ALL_JOBS if job.outputs[0] in made]
    times = {
        path: os.path.getmtime(path)
        for job in jobs
        for path in (*job.inputs, *job.outputs)
        if os.path.isfile(path)
    }
    late = [path for path, moment in times.items() if moment > time.time()]
    if late:
        print(f"{len(late)} files have a time in the future, as {late[0]}: set to now.", file=sys.stderr)
    if late or any(
        times.get(path, 0.0) > min(times.get(output, math.inf) for output in job.outputs)
        for job in jobs
        for path in job.inputs
    ):
        now = time.time()
        for path in {*late, *(path for path in times if path in made)}:
            with suppress(OSError):
                os.utime(path, (now, now))


def plan(faulty):
    """Say what would be removed; a dry run begins anew with these files forced, since they are still there."""
    if "SLIPPULSE_PLANNED" not in os.environ:
        say_faulty(faulty)
        if faulty and CALLED.dryrun:
            at = sys.argv.index("--") if "--" in sys.argv else len(sys.argv)
            forced = ["--forcerun", *(f"results/{name}" for name in faulty)]
            called = [sys.executable, "-m", "snakemake", *sys.argv[1:at], *forced, *sys.argv[at:]]
            os.execve(sys.executable, called, os.environ | {"SLIPPULSE_PLANNED": "yes"})


def say_outdated():
    """One line on results that this run has left behind, with the command that renews them."""
    tree = Tree("results", ORIGINS)
    left = [name for name in ORIGINS if Path("results", name).is_file() and tree.outdated(name)]
    if left:
        print(
            f"{len(left)} results are not as made by what is here now, as results/{left[-1]}:"
            f" {tree.outdated(left[-1])}. Renew them: {renewal()}",
            file=sys.stderr,
        )


def end_timers():
    """Of Snakemake, which would look for jobs again: its process would last until each is due."""
    for thread in threading.enumerate():
        if isinstance(thread, threading.Timer):
            thread.cancel()


def renewal():
    """The command that makes everything as this run was called."""
    if "MAKELEVEL" not in os.environ:
        return shlex.join(["snakemake", "--cores", str(workflow.cores), *OPTIONS, "--", "everything"])
    given = {name: os.environ.get(name) for name in ("PRESET", "OVERLAY", "ALLOW_LARGE")}
    return shlex.join(
        ["make", "replicate", *(f"{name}={value}" for name, value in given.items() if value)]
    ) + (" TARGET=everything")


def verify(complete):
    """Compare all results with what a complete run would make; ends the process."""
    problems, count = problems_of("results", ORIGINS, complete)
    print("\n".join(problems) or f"{count} files are as made by what is here now")
    whole = Tree("results", ORIGINS).behind(files_of("everything"))
    if skipped := [name for name in whole if not Path("results", name).exists() and name not in complete]:
        print(f"Not looked at: {len(skipped)} files that TARGET=everything makes besides, as {skipped[0]}")
    raise SystemExit(1 if problems else 0)


def heard(record):
    """Of what Snakemake logs: without a bar on a terminal one line a job; not that it has finished when it has failed."""
    if getattr(record, "done", None) and not sys.stderr.isatty():
        print(f"{record.done} of {record.total}", file=sys.stderr)
    return "Complete log" not in str(record.msg)


logger.addFilter(heard)


try:
    if workflow.is_main_process:
        refuse_unknown_targets()
        targets = sorted(CALLED.targets) or ["all"]
        if "verify" in targets:
            verify(Tree("results", ORIGINS).behind([*files_of("all"), *files_of(targets[0])]))
        refuse_places()
        TREE = Tree("results", ORIGINS)
        WANTED = TREE.behind(file for target in targets for file in files_of(target))
        refuse_expensive_targets(WANTED)
        if LOOKING:
            plan(TREE.to_remove(WANTED))
        else:
            LOCK = lock_folder()
            FAULTY = TREE.to_remove(WANTED)
            say_faulty(FAULTY)
            for name in FAULTY:
                Path("results", name).unlink()
            settle_times(WANTED)
            if not all(Path("results", name).exists() for name in WANTED):
                JOBS.begin()
            called = {"options": OPTIONS, "targets": targets, "page": "index.html" in WANTED}
            write_text(json.dumps(called), Path("results", CALL))
except ConfigError as error:
    refuse(str(error))
except OSError as error:
    refuse(f"{error.filename}: {error.strerror}")
