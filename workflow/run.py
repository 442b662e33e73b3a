"""Run Snakemake for make: short names of targets, results renewed, and the verdicts at the end.

    python workflow/run.py replicate|verify|rulegraph

The options of make are in the environment: CORES, PRESET, OVERLAY, TARGET, ALLOW_LARGE. A signal
ends the run at once, with all of its processes and with one line. Everything else is Snakemake's.
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

PROJECT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(PROJECT / "src"))
RESULTS, STATE = Path("results"), Path(".snakemake")
# Where docs/compare.md keeps the results from before an altered run.
KEPT = Path("shipped")
LAST_RUN = STATE / "slippulse-last-run.json"
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
OPTIONS = ("PRESET", "OVERLAY", "ALLOW_LARGE")
# Folders and files of results that no rule makes.
OTHER_PLACES = ("logs", "benchmarks", "reference", "tutorial", "site")
OTHER_PLACES += ("compare.html", "compare.csv")


def options_of(given: Mapping[str, str]) -> list[str]:
    """Return Snakemake's options for the options of make."""
    names = [name for name in ("PRESET", "ALLOW_LARGE") if given.get(name)]
    options = ["--config", *(f"{name.lower()}={given[name]}" for name in names)] if names else []
    if given.get("OVERLAY"):
        check_overlay(given["OVERLAY"])
        options += ["--configfile", given["OVERLAY"]]
    return options


def check_overlay(path: str) -> None:
    """Refuse an overlay that is no plain data, since Snakemake obeys templates."""
    from slippulse_paper.configuration.read import ConfigError, read_overlay

    try:
        read_overlay(path)
    except ConfigError as error:
        sys.exit(f"The configuration is refused:\n{error}")


def full_target(target: str) -> str:
    """Complete the short name of a figure, such as fig5, fig05.pdf or sweep_NAME.png."""
    name, _, ending = target.removeprefix("results/figures/").partition(".")
    modules = PROJECT / "src/slippulse_paper/figures"
    numbered = re.fullmatch(r"fig(?:ure)?_?0*(\d+)", name)
    if numbered:
        paths = modules.glob(f"fig{int(numbered[1]):02d}_*.py")
        name = next((path.stem for path in paths), name)
    drawn = name.startswith(("fig", "study_")) and (modules / f"{name}.py").exists()
    known = drawn or name.startswith("sweep_")
    return f"results/figures/{name}.{ending or 'png'}" if known else target


def take_over() -> None:
    """Remove what a killed run has left, unless another run is at work in this folder."""
    from slippulse.data.files import UNFINISHED_MARK
    from slippulse_paper.records.lock import take

    held = take(STATE / "slippulse.lock")
    if held is None:
        sys.exit("Another run is at work in this folder: wait for it, or stop it.")
    locks = [*STATE.glob("locks/*.lock")]
    if locks:
        for path in [*locks, *RESULTS.rglob(f".*{UNFINISHED_MARK}*")]:
            path.unlink(missing_ok=True)
        print("The last run was killed: its unfinished files are made again.", file=sys.stderr)
    held.close()


def changed_results() -> dict[str, str]:
    """Return results that are not what their jobs wrote, which Snakemake does not notice."""
    from slippulse_paper.records.job_records import RecordedFiles

    problems = dict(RecordedFiles(RESULTS).problems())
    for name in problems:
        if Path(name).is_dir():
            sys.exit(f"{name} is a folder; remove or rename it: a file of that name is needed")
    return problems


def renewal(options: list[str], targets: list[str]) -> list[str]:
    """Return Snakemake's options that renew the changed results among those of the targets."""
    problems = changed_results()
    if not problems:
        return []
    look = summary(options, targets)
    needed = {line.partition("\t")[0] for line in look.stdout.splitlines()}
    names = [name for name in problems if name in needed]
    if names:
        count = "1 result is" if len(names) == 1 else f"{len(names)} results are"
        print(f"{count} renewed: {names[0]}: {problems[names[0]]}", file=sys.stderr)
    return ["--forcerun", *names] if names else []


def summary(options: list[str], targets: list[str]) -> subprocess.CompletedProcess[str]:
    """Run Snakemake's --summary, which lists the files of the targets with their state."""
    look = ["--profile", "none", "--workflow-profile", "none", "--summary"]
    command = [sys.executable, "-m", "snakemake", *look, *options, "--", *targets]
    return subprocess.run(command, stdout=subprocess.PIPE, text=True, check=False)


def closing_line(targets: list[str], given: Mapping[str, str]) -> str:
    """Return what to open when a run has ended, with the verdicts if it made or kept them."""
    from slippulse_paper.claims.claim_texts import read_text
    from slippulse_paper.claims.ledger import Ledger
    from slippulse_paper.configuration.read import read_config, read_overlay
    from slippulse_paper.records.provenance import changes

    shipped = read_overlay(PROJECT / "config/config.yaml")
    overlays = [read_overlay(given["OVERLAY"])] if given.get("OVERLAY") else []
    preset = {"preset": given["PRESET"]} if given.get("PRESET") else {}
    config = read_config(shipped, overlays, preset, every_run=False)
    draft = targets in ([], ["all"]) and not config.presets[config.preset].whole
    whole = not draft and {*targets} <= {"all", "everything", "results/index.html"}
    text = ""
    if whole or any(target.startswith("results/claims.") for target in targets):
        ledger = Ledger(json.loads(Path("results/claims.json").read_text(encoding="utf-8")))
        text = f"{ledger.summary()}\n"
        if changes(shipped, {**config.given(), "preset": shipped["preset"]}):
            line = "Differs from the shipped: {key}: {shipped} -> {here}\n".format
            verdicts = read_text(PROJECT / "manuscript/shipped_verdicts.yaml")
            text += "".join(line(**change) for change in ledger.differences(verdicts))
    if whole:
        return f"{text}Open results/index.html"
    if draft:
        return "Open results/figures; TARGET=everything makes studies, claims and report too"
    return f"{text}Made: {', '.join(targets)}"


class Run:
    """Snakemake in a group of processes of its own, which ends with this process."""

    def __init__(self, arguments: list[str]) -> None:
        # A profile of the user may change what is made, or that anything is made.
        surroundings = {
            key: value for key, value in os.environ.items() if key != "SNAKEMAKE_PROFILE"
        }
        cache = Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache")
        try:
            cache.mkdir(parents=True, exist_ok=True)
        except OSError:
            # Snakemake needs a folder for its caches, and there may be no home on a cluster.
            surroundings["XDG_CACHE_HOME"] = str((STATE / "caches").resolve())
        command = [sys.executable, "-m", "snakemake", "--profile", "none", *arguments]
        self.process = subprocess.Popen(command, env=surroundings, start_new_session=True)
        # The shell waits for the other end of this pipe, which the system closes with this process.
        end_group = f"read _; kill -KILL -{self.process.pid}"
        how = {"stdin": subprocess.PIPE, "start_new_session": True}
        self.guard = subprocess.Popen(["sh", "-c", end_group], **how)

    def end(self) -> None:
        """End all processes of the run."""
        with suppress(ProcessLookupError):
            os.killpg(self.process.pid, signal.SIGKILL)

    def wait(self) -> int:
        """Wait for Snakemake and return its exit code."""
        code = self.process.wait()
        self.guard.kill()
        self.end()
        return code if code >= 0 else 128 - code


def replicate(given: Mapping[str, str]) -> int:
    """Make the targets, and print what to open. Returns the exit code."""
    began = time.monotonic()
    targets = [*map(full_target, given.get("TARGET", "").split())]
    options = options_of(given)
    if given.get("OVERLAY") and (RESULTS / "provenance.json").exists() and not KEPT.exists():
        line = "To see old beside new later, stop now, keep these results, and start again: "
        print(f"{line}cp -r {RESULTS} {KEPT} (docs/compare.md)", file=sys.stderr)
    take_over()
    renewed = renewal(options, targets)
    run = Run(["--cores", given.get("CORES") or "2", *options, *renewed, "--", *targets])

    def stop(number: int, _frame: object) -> None:
        for other in SIGNALS:
            signal.signal(other, signal.SIG_IGN)
        run.end()
        cursor = b"\x1b[?25h" if sys.stderr.isatty() else b""
        os.write(2, cursor + b"\nStopped; the next run goes on from what is there.\n")
        sys.exit(128 + number)

    for number in SIGNALS:
        signal.signal(number, stop)
    code = run.wait()
    if code == 0:
        last = {"options": {name: given[name] for name in OPTIONS if given.get(name)}}
        last["targets"] = ["everything"] if "everything" in targets else []
        LAST_RUN.write_text(json.dumps(last), encoding="utf-8")
        time_taken = timedelta(seconds=round(time.monotonic() - began))
        print(f"{closing_line(targets, given)}. It took {time_taken}.")
        if given.get("OVERLAY") and KEPT.exists():
            print(f"Old beside new: make compare AGAINST={KEPT}")
    return code


def wanted(given: Mapping[str, str]) -> tuple[dict[str, str], list[str]]:
    """Return the options and targets to verify: without options, those of the last run."""
    options = {name: given[name] for name in OPTIONS if given.get(name)}
    targets = [*map(full_target, given.get("TARGET", "").split())]
    if not options:
        with suppress(OSError, ValueError, KeyError, TypeError, AttributeError, RecursionError):
            last = json.loads(LAST_RUN.read_text(encoding="utf-8"))
            last_options = {name: str(value) for name, value in last["options"].items()}
            options, targets = last_options, targets or [*{"everything"} & {*last["targets"]}]
    return options, targets


def verify(given: Mapping[str, str]) -> int:
    """Print each result that is not as a run would make it now. Returns the exit code."""
    options, targets = wanted(given)
    look = summary(options_of(options), targets)
    if look.returncode:
        return look.returncode
    problems = dict(outdated(look.stdout))
    problems |= dict(unrecorded(problems))
    for name, reason in sorted(problems.items()):
        print(f"{name}: {reason}")
    if not problems:
        files = look.stdout.count("\n") - 1
        print(f"{files} files are as a run would make them now")
    return int(bool(problems))


def rulegraph(given: Mapping[str, str]) -> int:
    """Print which rules make what, as a mermaid graph. Returns the exit code."""
    targets = [*map(full_target, given.get("TARGET", "").split())]
    targets = targets or ["results/figures/fig05_scaling.png", "results/claims.json"]
    look = ["--profile", "none", "--workflow-profile", "none", "--quiet", "all"]
    graph = ["--rulegraph", "mermaid-js", "--", *targets]
    command = [sys.executable, "-m", "snakemake", *look, *options_of(given), *graph]
    return subprocess.run(command, check=False).returncode


def outdated(summary: str) -> Iterable[tuple[str, str]]:
    """Yield the files that Snakemake would make again, with its reason, from its summary."""
    for line in summary.splitlines()[1:]:
        name, *_, status, plan = line.split("\t")
        if plan != "no update" or status == "missing":
            yield name, status if status != "ok" else "made from files that are not up to date"


def unrecorded(outdated: Mapping[str, str]) -> Iterable[tuple[str, str]]:
    """Yield the files that are not what their jobs wrote, and those that no job wrote."""
    from slippulse_paper.records.job_records import RecordedFiles

    recorded = RecordedFiles(RESULTS)
    yield from recorded.problems()
    known = recorded.states()
    for path in sorted(RESULTS.rglob("*")):
        parts = path.relative_to(RESULTS).parts
        hidden = any(part.startswith(".") for part in parts)
        ours = path.is_file() and not hidden and parts[0] not in OTHER_PLACES
        if ours and str(path) not in known and str(path) not in outdated:
            yield str(path), "no job has recorded it"


if __name__ == "__main__":
    commands = {"replicate": replicate, "verify": verify, "rulegraph": rulegraph}
    sys.exit(commands[sys.argv[1]](os.environ))
