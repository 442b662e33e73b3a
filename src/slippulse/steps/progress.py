"""What a job says of its progress."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

# Seconds between two lines.
BETWEEN = 2.0


def lines(name: str) -> Callable[[float, int], None]:
    """A function of how many runs are done and of how many there are, which says the time that is left."""
    began = shown = time.monotonic()

    def say(done: float, total: int) -> None:
        nonlocal shown
        now = time.monotonic()
        if 0 < done < total and now - shown > BETWEEN:
            shown = now
            left = (now - began) * (total / done - 1.0)
            part = f"{done:.0%} of the run" if total == 1 else f"{done} of {total} runs"
            sys.stderr.write(f"  {name}: {part}, about {left:.0f} s left\n")
            sys.stderr.flush()

    return say
