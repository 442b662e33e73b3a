"""A bar that shows the progress of a simulation or of a sweep."""

import sys
from collections.abc import Callable

LOOK = "{percentage:3.0f}% |{bar}| {elapsed}, {remaining} left"


def bar(total: float = 1.0) -> Callable[..., None] | None:
    """Return a function of what is done, up to a total, that draws a bar; None without tqdm.

    The bar is drawn on standard error, in a notebook as a widget.
    """
    try:
        from tqdm.auto import tqdm
    except ImportError:
        print("progress: tqdm is not installed, so that no bar is drawn", file=sys.stderr)
        return None
    drawn = tqdm(total=total, delay=0.2, mininterval=0.2, bar_format=LOOK)

    def draw(done: float, _: float = total) -> None:
        drawn.update(done - drawn.n)
        if done >= total:
            drawn.close()

    return draw
