"""A bar in the terminal for one long run."""

from __future__ import annotations

import sys
from collections.abc import Callable


def bar(stream=None) -> Callable[[float], None]:
    """A function of the fraction done that draws a bar with the time that is left.

    Parameters
    ----------
    stream : where to; standard error when left out
    """
    from tqdm import tqdm

    shown = tqdm(
        total=1.0, delay=0.2, mininterval=0.2, file=stream or sys.stderr,
        bar_format="[{bar:30}] {percentage:3.0f}%  {elapsed}, {remaining} left",
    )  # fmt: skip

    def draw(done: float) -> None:
        shown.update(done - shown.n)
        if done >= 1.0:
            shown.close()

    return draw
