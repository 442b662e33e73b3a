"""Run Snakemake for make. A signal ends the run at once, with all of its jobs and with one line.

    python workflow/run.py replicate|verify

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

CALL = Path("results/records/.call")
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def arguments(command: str) -> list[str]:
    """Arguments of Snakemake for a command of the Makefile."""
    given = {name: value for name, value in os.environ.items() if value}
    targets = [full_target(target) for target in given.get("TARGET", "").split()]
    names = [name for name in ("PRESET", "ALLOW_LARGE") if name in given]
    options = ["--config", *(f"{name.lower()}={given[name]}" for name in names)] if names else []
    options += ["--configfile", checked(given["OVERLAY"])] if "OVERLAY" in given else []
    if command == "replicate":
        return ["--cores", given.get("CORES", "2"), *options, "--", *targets]
    if not options:
        # Without options, the results are compared with what the last run was to make.
        with suppress(OSError, ValueError, KeyError, TypeError, RecursionError):
            called = json.loads(CALL.read_text(encoding="utf-8"))
            targets = [*{"everything"} & {*called["targets"]}]
            options = [str(option) for option in called["options"]]
    look = ("--workflow-profile", "none", "--logger", "slippulse", "--quiet", "all")
    return [*look, "--cores", "1", *options, "--", "verify", *targets]


def checked(overlay: str) -> str:
    """Refuse an overlay that is no plain data, since Snakemake obeys templates."""
    from slippulse_paper.configuration.read import ConfigError, read_overlay

    try:
        read_overlay(overlay)
    except ConfigError as error:
        sys.exit(f"The configuration is refused:\n{error}")
    return overlay


def full_target(target: str) -> str:
    """Complete the short name of a figure, such as fig5, fig05.pdf or sweep_NAME.png."""
    name, _, ending = target.removeprefix("results/figures/").partition(".")
    modules = Path("src/slippulse_paper/figures")
    numbered = re.fullmatch(r"fig(?:ure)?_?0*(\d+)", name)
    if numbered:
        paths = modules.glob(f"fig{int(numbered[1]):02d}_*.py")
        name = next((path.stem for path in paths), name)
    drawn = name.startswith(("fig", "study_")) and (modules / f"{name}.py").exists()
    known = drawn or name.startswith("sweep_")
    return f"results/figures/{name}.{ending or 'png'}" if known else target


def answer() -> str:
    """Say what to open when a run has ended, with the verdicts if it made or kept them."""
    called = json.loads(CALL.read_text(encoding="utf-8"))
    text = ""
    if called["judged"]:
        from slippulse_paper.claims.claim_texts import read_text
        from slippulse_paper.claims.ledger import Ledger

        ledger = Ledger(json.loads(Path("results/claims.json").read_text(encoding="utf-8")))
        text = f"{ledger.summary()}\n"
        if called["altered"]:
            line = "Differs from the shipped: {key}: {shipped} -> {here}\n".format
            shipped = read_text("manuscript/shipped_verdicts.yaml")
            text += "".join(line(**change) for change in ledger.differences(shipped))
    if called["page"]:
        return f"{text}Open results/index.html"
    if called["targets"] == ["all"]:
        return "Open results/figures; TARGET=everything makes studies, ledger and report too"
    return f"{text}Made: {', '.join(called['targets'])}"


def main(command: str) -> int:
    """Run Snakemake in a group of processes of its own; returns the exit code."""
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
        cursor = b"\x1b[?25h" if sys.stderr.isatty() else b""
        os.write(2, cursor + b"\nStopped; the next run goes on from what is there.\n")
        sys.exit(128 + number)

    for number in SIGNALS:
        signal.signal(number, stop)
    process = subprocess.Popen(
        [sys.executable, "-m", "snakemake", *arguments(command)],
        env=os.environ | {"SLIPPULSE_LEASH": str(leash)},
        pass_fds=[leash],
        start_new_session=True,
    )
    os.close(leash)
    code = process.wait()
    # Jobs would go on after a server of jobs that has died.
    end()
    if code == 0 and command == "replicate":
        print(f"{answer()}. It took {timedelta(seconds=round(time.monotonic() - began))}.")
    return code if code >= 0 else 128 - code


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
