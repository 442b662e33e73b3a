"""A bar that shows the progress of a simulation or of a sweep."""

import sys
from collections.abc import Callable

BAR_FORMAT = "{percentage:3.0f}% |{bar}| {elapsed}, {remaining} left"


def make_bar(total: float = 1.0) -> Callable[..., None] | None:
    """Return a function that draws a bar when it is called with the amount done, up to a total.

    The bar appears on standard error, or as a widget in a notebook. Return None if tqdm is not
    installed.
    """
    try:
        from tqdm.auto import tqdm
    except ImportError:
        print("progress: no bar is drawn, since tqdm is not installed", file=sys.stderr)
        return None
    bar = tqdm(total=total, delay=0.2, mininterval=0.2, bar_format=BAR_FORMAT)

    def draw(done: float, _: float = total) -> None:
        """Draw the bar with the amount done, and close it when this is the total of the bar.

        A sweep also passes the total as the second argument, which is not needed.
        """
        # tqdm takes the amount done since the last time.
        bar.update(done - bar.n)
        if done >= total:
            bar.close()

    return draw
