"""A bar in the terminal for one long scene."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable

WIDTH = 30
# Seconds between two drawings, and before the first.
BETWEEN = 0.2


def bar(stream=None) -> Callable[[float], None]:
    """A function of the share done that draws a bar with the time that is left.

    Parameters
    ----------
    stream : where to; standard error when left out
    """
    out = sys.stderr if stream is None else stream
    began = drawn = time.monotonic()

    def draw(share: float) -> None:
        nonlocal drawn
        now = time.monotonic()
        done = share >= 1.0
        if (now - drawn < BETWEEN and not done) or (done and drawn == began):
            return
        drawn = now
        filled = round(WIDTH * share)
        left = (now - began) * (1.0 / share - 1.0) if share > 0.0 else 0.0
        tail = f"{now - began:.0f} s\n" if done else f"{left:.0f} s left"
        out.write(f"\r[{'#' * filled}{'.' * (WIDTH - filled)}] {share:4.0%}  {tail}   ")
        out.flush()

    return draw
