"""Run Snakemake for the commands of make.

    python workflow/run.py replicate|verify|rulegraph

The options of make are environment variables: CORES, PRESET, OVERLAY, TARGET and ALLOW_LARGE. In
addition to what Snakemake does, targets may have short names, results that were edited by hand are
made again, and the verdicts are printed at the end. A signal ends the run and all its processes at
once, and one line is printed.
"""

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Iterable, Mapping
from contextlib import suppress
from datetime import timedelta
from pathlib import Path
from typing import TextIO

PROJECT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(PROJECT / "src"))
RESULTS, STATE = Path("results"), Path(".snakemake")
# According to docs/compare.md, users copy their results to this folder before they make new ones.
KEPT_RESULTS = Path("shipped")
LAST_RUN = STATE / "slippulse-last-run.json"
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
# Options of make that change the results.
OPTIONS = ("PRESET", "OVERLAY", "ALLOW_LARGE")
ALLOWED_TARGETS = (
    "allowed: a figure (fig1 to fig11, or a name in docs/figures.md), everything, scenes,"
    " a file such as results/claims.html, or a rule of your own"
)
# Folders and files of results that are not made by rules.
PATHS_WITHOUT_RULES = ("logs", "benchmarks", "reference", "tutorial", "site")
PATHS_WITHOUT_RULES += ("compare.html", "compare.csv")


def snakemake_options(make_options: Mapping[str, str]) -> list[str]:
    """Return the options of Snakemake for the options PRESET, ALLOW_LARGE and OVERLAY of make.

    Exits with the reason if the overlay cannot be read.
    """
    values = []
    for name in ("PRESET", "ALLOW_LARGE"):
        if make_options.get(name):
            values.append(f"{name.lower()}={make_options[name]}")
    options = ["--config", *values] if values else []
    if make_options.get("OVERLAY"):
        check_overlay(make_options["OVERLAY"])
        options += ["--configfile", make_options["OVERLAY"]]
    return options


def targets_of(make_options: Mapping[str, str]) -> list[str]:
    """Return the targets of make. Short names of figures are replaced by paths."""
    return [full_target(target) for target in make_options.get("TARGET", "").split()]


def check_overlay(path: str) -> None:
    """Exit with the reason if an overlay is not plain data.

    Snakemake would execute templates in an overlay.
    """
    from slippulse_paper.configuration.read import ConfigError, read_overlay

    try:
        read_overlay(path)
    except ConfigError as error:
        sys.exit(f"The configuration is refused:\n{error}")


def full_target(target: str) -> str:
    """Return the path of a figure from its short name, such as fig5, fig05.pdf or sweep_NAME.

    Other targets are returned as they are.
    """
    name, _, ending = target.removeprefix("results/figures/").partition(".")
    modules = PROJECT / "src/slippulse_paper/figures"
    # A figure of the paper may be given by its number alone. Its module has the full name.
    numbered = re.fullmatch(r"fig(?:ure)?_?0*(\d+)", name)
    if numbered:
        number = int(numbered[1])
        for path in modules.glob(f"fig{number:02d}_*.py"):
            name = path.stem
    has_module = name.startswith(("fig", "study_")) and (modules / f"{name}.py").exists()
    # The figures of user-defined sweeps have no modules of their own.
    is_figure = has_module or name.startswith("sweep_")
    return f"results/figures/{name}.{ending or 'png'}" if is_figure else target


def is_unknown(target: str) -> bool:
    """Return True if a target is neither a path nor the name of a rule of this project."""
    rules = "\n".join(
        path.read_text(encoding="utf-8")
        for path in [PROJECT / "Snakefile", *PROJECT.glob("workflow/rules/*.smk")]
    )
    return "/" not in target and not re.search(rf"^rule {re.escape(target)}:", rules, re.MULTILINE)


def lock_folder_and_clean_up() -> TextIO:
    """Lock this folder for the run, and remove the unfinished files of a killed run.

    Returns the lock of make, which make holds until its run ends. The lock of Snakemake is released
    here, because the Snakemake that make starts takes it. Exits if another run holds a lock.
    """
    from slippulse.data.files import UNFINISHED_MARK
    from slippulse_paper.records.lock import take

    make_lock = take(STATE / "slippulse-make.lock")
    snakemake_lock = take(STATE / "slippulse.lock")
    if make_lock is None or snakemake_lock is None:
        sys.exit("Another run is using this folder: wait for it, or stop it.")
    # Snakemake removes its own locks unless it is killed.
    locks_of_killed_run = [*STATE.glob("locks/*.lock")]
    if locks_of_killed_run:
        unfinished_files = RESULTS.rglob(f".*{UNFINISHED_MARK}*")
        for path in [*locks_of_killed_run, *unfinished_files]:
            path.unlink(missing_ok=True)
        print("The last run was killed: its unfinished files are made again.", file=sys.stderr)
    snakemake_lock.close()
    return make_lock


def changed_results() -> dict[str, str]:
    """Return the results that must be made again although Snakemake does not notice it.

    The result maps each of them to the reason: for example, it was edited by hand. Exits if a
    folder has taken the place of a file.
    """
    from slippulse_paper.records.job_records import RecordedFiles

    problems = dict(RecordedFiles(RESULTS).problems())
    for name in problems:
        if Path(name).is_dir():
            sys.exit(f"{name} is a folder; remove or rename it: a file of that name is needed")
    return problems


def options_for_changed_results(options: list[str], targets: list[str]) -> list[str]:
    """Return options of Snakemake that make changed results again, if the targets need them.

    Prints how many results these are, with the first one and its reason.
    """
    reasons = changed_results()
    if not reasons:
        return []
    # If Snakemake refuses the targets, the run itself prints the reason later.
    listing = list_required_files(options, targets, stderr=subprocess.DEVNULL)
    required_outputs = {line.partition("\t")[0] for line in listing.stdout.splitlines()}
    names = [name for name in reasons if name in required_outputs]
    if not names:
        return []
    first = names[0]
    results_are = "1 result is" if len(names) == 1 else f"{len(names)} results are"
    print(f"{results_are} made again: {first}: {reasons[first]}", file=sys.stderr)
    return ["--forcerun", *names]


def list_required_files(
    options: list[str], targets: list[str], stderr: int | None = None
) -> subprocess.CompletedProcess[str]:
    """Run Snakemake with --summary, which lists each file that the targets need, with its state.

    stderr : where messages of Snakemake go, as in `subprocess.run`
    """
    summary_options = ["--profile", "none", "--workflow-profile", "none", "--summary"]
    command = [sys.executable, "-m", "snakemake", *summary_options, *options, "--", *targets]
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=stderr, text=True, check=False)


def closing_text(targets: list[str], make_options: Mapping[str, str]) -> str:
    """Return the text that is printed after a run.

    It has the verdicts, if the targets include them, and says what to open.
    """
    from slippulse_paper.configuration.read import read_config, read_overlay

    # The configuration of the run.
    shipped = read_overlay(PROJECT / "config/config.yaml")
    overlays = [read_overlay(make_options["OVERLAY"])] if make_options.get("OVERLAY") else []
    preset = {"preset": make_options["PRESET"]} if make_options.get("PRESET") else {}
    config = read_config(shipped, overlays, preset, every_run=False)
    # Without targets, a preset that is not `whole`, such as draft, makes only the paper's figures.
    makes_everything = config.presets[config.preset].whole
    if targets in ([], ["all"]) and not makes_everything:
        return "Open results/figures; TARGET=everything also makes studies, claims and report"
    # With these targets, or without targets, the run makes the page with all results.
    has_index = {*targets} <= {"all", "everything", "results/index.html"}
    text = ""
    if has_index or any(target.startswith("results/claims.") for target in targets):
        text = verdicts_text(shipped, config.given())
    end = "Open results/index.html" if has_index else f"Made: {', '.join(targets)}"
    return text + end


def verdicts_text(shipped: Mapping, config: Mapping) -> str:
    """Return lines with the number of claims of each verdict, and with the changed verdicts.

    shipped, config : the shipped configuration, and that of the run

    The verdicts are compared with the shipped ones only if the configuration differs from the
    shipped one in more than the preset.
    """
    from slippulse_paper.claims.claim_texts import read_text
    from slippulse_paper.claims.ledger import Ledger
    from slippulse_paper.records.provenance import changes

    ledger = Ledger(json.loads(Path("results/claims.json").read_text(encoding="utf-8")))
    text = f"{ledger.summary()}\n"
    if changes(shipped, {**config, "preset": shipped["preset"]}):
        shipped_verdicts = read_text(PROJECT / "manuscript/shipped_verdicts.yaml")
        for change in ledger.differences(shipped_verdicts):
            verdicts = f"{change['shipped']} -> {change['here']}"
            text += f"Differs from the shipped verdict: {change['key']}: {verdicts}\n"
    return text


class Run:
    """A run of Snakemake in a separate process group. The group ends when this process ends."""

    def __init__(self, arguments: list[str]) -> None:
        """Start Snakemake with some arguments, and a shell that watches this process."""
        # A profile of the user could change what is made.
        environment = {
            key: value for key, value in os.environ.items() if key != "SNAKEMAKE_PROFILE"
        }
        cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        try:
            cache.mkdir(parents=True, exist_ok=True)
        except OSError:
            # Snakemake needs a folder for its caches. On a cluster there may be no home folder.
            environment["XDG_CACHE_HOME"] = str((STATE / "caches").resolve())
        command = [sys.executable, "-m", "snakemake", "--profile", "none", *arguments]
        self.process = subprocess.Popen(command, env=environment, start_new_session=True)
        # A shell waits for the end of its input, which is a pipe from this process. If this process
        # is killed, the system closes the pipe, and the shell kills the process group.
        end_group = f"read _; kill -KILL -{self.process.pid}"
        self.waiting_shell = subprocess.Popen(
            ["sh", "-c", end_group], stdin=subprocess.PIPE, start_new_session=True
        )

    def end(self) -> None:
        """End all processes of the run."""
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)

    def wait(self) -> int:
        """Wait for Snakemake, end all other processes of the run, and return the exit code."""
        code = self.process.wait()
        # This shell would end the run if this process were killed. It is no longer needed.
        self.waiting_shell.kill()
        self.end()
        # A negative code is a signal. Shells report signal N as 128 + N.
        return code if code >= 0 else 128 - code


def end_on_signals(run: Run) -> None:
    """Make this process end its run, print one line and exit when it gets a signal."""

    def stop(number: int, _frame: object) -> None:
        """End the run and this process, and ignore further signals meanwhile."""
        for further_signal in SIGNALS:
            signal.signal(further_signal, signal.SIG_IGN)
        run.end()
        # A progress bar hides the cursor of the terminal.
        show_cursor = b"\x1b[?25h" if sys.stderr.isatty() else b""
        os.write(2, show_cursor + b"\nStopped; the next run continues from the finished files.\n")
        sys.exit(128 + number)

    for number in SIGNALS:
        signal.signal(number, stop)


def replicate(make_options: Mapping[str, str]) -> int:
    """Make the targets, print what to open, and return the exit code."""
    began = time.monotonic()
    targets, options = targets_of(make_options), snakemake_options(make_options)
    has_results = (RESULTS / "provenance.json").exists()
    if make_options.get("OVERLAY") and has_results and not KEPT_RESULTS.exists():
        line = "To compare these results with the new ones, stop now, copy them, and start again: "
        print(f"{line}cp -r {RESULTS} {KEPT_RESULTS} (docs/compare.md)", file=sys.stderr)
    # Run Snakemake.
    lock = lock_folder_and_clean_up()
    cores = ["--cores", make_options.get("CORES") or "2"]
    options += options_for_changed_results(options, targets)
    run = Run([*cores, *options, "--", *targets])
    end_on_signals(run)
    code = run.wait()
    lock.close()
    # If the run has failed, a target that does not exist may be the reason.
    unknown = [target for target in targets if is_unknown(target)]
    if code != 0 and unknown:
        names = ", ".join(unknown)
        print(f"TARGET: {names}, no rule of this project; {ALLOWED_TARGETS}", file=sys.stderr)
    if code == 0:
        record_run(make_options, targets)
        time_taken = timedelta(seconds=round(time.monotonic() - began))
        print(f"{closing_text(targets, make_options)}. It took {time_taken}.")
        if make_options.get("OVERLAY") and KEPT_RESULTS.exists():
            command = f"make compare AGAINST={KEPT_RESULTS}"
            print(f"To compare the old results with the new ones: {command}")
    return code


def result_options(make_options: Mapping[str, str]) -> dict[str, str]:
    """Return those options of make that change the results, if they have a value."""
    return {name: make_options[name] for name in OPTIONS if make_options.get(name)}


def record_run(make_options: Mapping[str, str], targets: list[str]) -> None:
    """Write the options that change results, and the targets, to a file, which `verify` reads.

    Of the targets, only "everything" is recorded. After a run of one figure, for example, `verify`
    still examines all results that are made by default.
    """
    recorded_targets = ["everything"] if "everything" in targets else []
    last_run = {"options": result_options(make_options), "targets": recorded_targets}
    LAST_RUN.write_text(json.dumps(last_run), encoding="utf-8")


def verified_run(make_options: Mapping[str, str]) -> tuple[dict[str, str], list[str]]:
    """Return the options and targets that `verify` uses.

    They are those of make. If make has no options that change results, the options are those of the
    last run. If make has no targets either, the target is "everything" if the last run made it. No
    target means the targets that are made by default.
    """
    options, targets = result_options(make_options), targets_of(make_options)
    if not options:
        # Without a readable record of a run, the shipped configuration is verified.
        with suppress(OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
            last_run = json.loads(LAST_RUN.read_text(encoding="utf-8"))
            last_targets = ["everything"] if "everything" in last_run["targets"] else []
            options = {name: str(value) for name, value in last_run["options"].items()}
            targets = targets or last_targets
    return options, targets


def verify(make_options: Mapping[str, str]) -> int:
    """Print each result that differs from what a run would make now, and return the exit code.

    A result is printed if Snakemake would make it again, if it was changed by hand, or if no job
    has recorded it. The exit code is 1 if there is any such result.
    """
    from slippulse_paper.records.job_records import RecordedFiles

    options, targets = verified_run(make_options)
    listing = list_required_files(snakemake_options(options), targets)
    if listing.returncode:
        return listing.returncode
    recorded = RecordedFiles(RESULTS)
    outdated = dict(outdated_files(listing.stdout))
    unrecorded = files_without_job({*recorded.states(), *outdated})
    problems = outdated | dict(recorded.problems())
    problems |= dict.fromkeys(unrecorded, "no job has recorded it")
    for name, reason in sorted(problems.items()):
        print(f"{name}: {reason}")
    if not problems:
        # The first line of the listing is its header.
        file_count = listing.stdout.count("\n") - 1
        print(f"{file_count} files are as a run would make them now")
    return int(bool(problems))


def rulegraph(make_options: Mapping[str, str]) -> int:
    """Print the graph of the rules in the mermaid format, and return the exit code."""
    # A figure and the verdicts need the main rules. The graph of all rules is hard to read.
    targets = targets_of(make_options) or [
        "results/figures/fig05_scaling.png",
        "results/claims.json",
    ]
    quiet = ["--profile", "none", "--workflow-profile", "none", "--quiet", "all"]
    graph = ["--rulegraph", "mermaid-js", "--", *targets]
    command = [sys.executable, "-m", "snakemake", *quiet, *snakemake_options(make_options), *graph]
    return subprocess.run(command, check=False).returncode


def outdated_files(summary: str) -> Iterable[tuple[str, str]]:
    """Yield the files that Snakemake would make again, with the reasons.

    ``summary`` is the text that Snakemake prints with --summary.
    """
    # The first line is the header.
    for line in summary.splitlines()[1:]:
        # The first column is the file. The last two are its status and what Snakemake plans.
        name, *_, status, plan = line.split("\t")
        # Snakemake plans no update for a missing file if the files made from it are up to date.
        if plan != "no update" or status == "missing":
            yield name, "made from files that are not up to date" if status == "ok" else status


def files_without_job(known_files: set[str]) -> set[str]:
    """Return the files in the folder of results that no rule has made.

    Hidden files and those in PATHS_WITHOUT_RULES are left out.

    known_files : files that are left out, too: those with a record, and those that are outdated
    """
    from slippulse_paper.records.job_records import made_without_step

    unknown_files = set()
    for path in RESULTS.rglob("*"):
        parts = path.relative_to(RESULTS).parts
        is_hidden = any(part.startswith(".") for part in parts)
        if path.is_file() and not is_hidden and parts[0] not in PATHS_WITHOUT_RULES:
            unknown_files.add(str(path))
    unknown_files -= known_files
    # Also leave out the files that rules of the user have made, which write no records.
    return unknown_files - made_without_step(unknown_files)


if __name__ == "__main__":
    # Until a run starts, an interrupt ends this process at once, and without a traceback.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    commands = {"replicate": replicate, "verify": verify, "rulegraph": rulegraph}
    sys.exit(commands[sys.argv[1]](os.environ))
