"""Writing of files, whole or not at all."""

import os
from collections.abc import Callable
from pathlib import Path

# The environment variable in which a job holds the digest of its configuration.
CONFIGURATION = "SLIPPULSE_CONFIGURATION"
# Part of the hidden name that a file has until it is complete; no other file has it.
UNFINISHED = ".slippulse-unfinished-"


class UnreadableFile(ValueError):
    """A file of the pipeline that is cut short, corrupted or edited beyond reading."""

    def __init__(self, path: str | Path, reason: object) -> None:
        text = " ".join(str(reason).split())[:120]
        super().__init__(f"{path}: cannot be read ({text}); delete it and run again")


def configuration() -> str:
    """Digest of the configuration behind the files of this job; empty outside the workflow."""
    return os.environ.get(CONFIGURATION, "")


def write_whole(path: str | Path, write: Callable[[Path], object]) -> None:
    """Let ``write`` fill a file beside ``path``, and move it there when it is complete."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.stem}{UNFINISHED}{os.urandom(4).hex()}{path.suffix}")
    try:
        write(part)
        part.replace(path)
    finally:
        part.unlink(missing_ok=True)


def write_text(text: str, path: str | Path) -> None:
    """Write a text file in UTF-8."""
    write_whole(path, lambda part: part.write_text(text, encoding="utf-8"))
