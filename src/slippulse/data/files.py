"""Write files so that each is either complete or absent."""

import os
from collections.abc import Callable
from pathlib import Path

# Environment variable in which the workflow passes the digest of its configuration to a job.
CONFIGURATION_VARIABLE = "SLIPPULSE_CONFIGURATION"
# A file has a hidden name with this part until it is complete. No other file has such a name.
UNFINISHED_MARK = ".slippulse-unfinished-"


class UnreadableFile(ValueError):
    """Error about a file that cannot be read, because it is incomplete, damaged or edited."""

    def __init__(self, path: str | Path, reason: object) -> None:
        text = " ".join(str(reason).split())[:120]
        super().__init__(f"{path}: cannot be read ({text}); delete the file and run again")


def configuration_digest() -> str:
    """Return the digest of this job's configuration; empty text outside the workflow."""
    return os.environ.get(CONFIGURATION_VARIABLE, "")


def write_whole(path: str | Path, write: Callable[[Path], object]) -> None:
    """Call ``write`` with a temporary path, and rename the file to ``path`` when it is complete.

    If ``write`` fails, the temporary file is deleted and ``path`` stays as it was.
    """
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    random_text = os.urandom(4).hex()
    unfinished = path.with_name(f".{path.stem}{UNFINISHED_MARK}{random_text}{path.suffix}")
    try:
        write(unfinished)
        unfinished.replace(path)
    finally:
        unfinished.unlink(missing_ok=True)


def write_text(text: str, path: str | Path) -> None:
    """Write a text file in UTF-8, which is either complete or absent."""
    write_whole(path, lambda unfinished: unfinished.write_text(text, encoding="utf-8"))
