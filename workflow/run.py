"""Run Snakemake for make, so that a signal ends the run at once, with all of its jobs and with one line.

    python workflow/run.py replicate|verify

Files are written whole or not at all, so that a run may be killed at any time: the next one goes on from what is there.
The options of make are in the environment: CORES, PRESET, OVERLAY, TARGET, ALLOW_LARGE.
"""

import json
import os
import re
import signal
import subprocess
import sys
import time
from contextlib import suppress
from datetime import timedelta
from pathlib import Path

# How the last run was called.
CALL = Path("results/records/.call")
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def arguments(what: str) -> list[str]:
    """Of Snakemake, for a target of the Makefile."""
    given = {name: value for name, value in os.environ.items() if value}
    targets = [meant(target) for target in given.get("TARGET", "").split()]
    values = [
        f"{name.lower()}={given[name]}" for name in ("PRESET", "ALLOW_LARGE") if name in given
    ]
    options = ["--config", *values] if values else []
    options += ["--configfile", given["OVERLAY"]] if "OVERLAY" in given else []
    if what == "verify":
        if not options:
            # As the last run was called.
            with suppress(OSError, ValueError, KeyError):
                called = json.loads(CALL.read_text(encoding="utf-8"))
                options, targets = called["options"], [*{"everything"} & {*called["targets"]}]
        look = ("--workflow-profile", "none", "--quiet", "all", "--cores", "1")
        return [*look, *options, "--", "verify", *targets]
    return ["--cores", given.get("CORES", "2"), *options, "--", *targets]


def meant(target: str) -> str:
    """A figure by less than its path, as fig5, fig05.png or study_arrest.pdf, as Snakemake knows it; else the same."""
    name, dot, ending = target.removeprefix("results/figures/").partition(".")
    short = re.fullmatch(r"fig(?:ure)?_?0*(\d+)", name)
    start = f"fig{int(short[1]):02d}_" if short else None
    for path in sorted(Path("src/slippulse/figures").glob("*_*.py")):
        if path.stem == name or (start and path.stem.startswith(start)):
            return f"results/figures/{path.stem}.{ending}" if dot else path.stem
    return target


def answer() -> str:
    """What to open when a run has ended, with the verdicts if it made or kept them."""
    called = json.loads(CALL.read_text(encoding="utf-8"))
    if called["page"]:
        from slippulse.claims.reading import Ledger

        ledger = Ledger(json.loads(Path("results/claims.json").read_text(encoding="utf-8")))
        return f"{ledger.summary()}\nOpen results/index.html"
    if called["targets"] == ["all"]:
        return "Open results/figures; TARGET=everything makes studies, ledger and report too"
    return f"Made: {', '.join(called['targets'])}"


def main(what: str) -> int:
    """Run it in a group of processes of its own; returns the exit code."""
    began = time.monotonic()
    # When this process ends, however that happens, the other end of this pipe tells Snakemake.
    leash, _held = os.pipe()
    process = None

    def end() -> None:
        with suppress(ProcessLookupError, AttributeError):
            os.killpg(process.pid, signal.SIGKILL)

    def stop(number: int, _frame: object) -> None:
        for other in SIGNALS:
            signal.signal(other, signal.SIG_IGN)
        end()
        cursor = "\x1b[?25h" if sys.stderr.isatty() else ""
        os.write(2, f"{cursor}\nStopped; the next run goes on from what is there.\n".encode())
        sys.exit(128 + number)

    for number in SIGNALS:
        signal.signal(number, stop)
    command = [sys.executable, "-m", "snakemake", *arguments(what)]
    process = subprocess.Popen(
        command,
        env=os.environ | {"SLIPPULSE_LEASH": str(leash)},
        pass_fds=[leash],
        start_new_session=True,
    )
    os.close(leash)
    code = process.wait()
    end()  # of jobs too, which would go on after a server that has died
    if code == 0 and what == "replicate":
        print(f"{answer()}. It took {timedelta(seconds=round(time.monotonic() - began))}.")
    return code if code >= 0 else 128 - code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
