"""One form for every refusal: the key, the value it had, and what is allowed."""

from __future__ import annotations

import math
from numbers import Real


def check_number(
    key: str,
    value: object,
    *,
    above: float | None = None,
    at_least: float | None = None,
    at_most: float | None = None,
    below: float | None = None,
) -> None:
    """Refuse anything but a finite number in the stated range.

    Raises
    ------
    ValueError
        Naming the key, the value and the range.
    """
    bounds = [
        f"> {above:g}" if above is not None else "",
        f">= {at_least:g}" if at_least is not None else "",
        f"<= {at_most:g}" if at_most is not None else "",
        f"< {below:g}" if below is not None else "",
    ]
    allowed = " and ".join(["a finite number", *(bound for bound in bounds if bound)])
    good = isinstance(value, Real) and not isinstance(value, bool) and math.isfinite(value)
    if good:
        good = (
            (above is None or value > above)
            and (at_least is None or value >= at_least)
            and (at_most is None or value <= at_most)
            and (below is None or value < below)
        )
    if not good:
        raise ValueError(f"{key}: {value!r}; allowed: {allowed}")


def check_choice(key: str, value: object, choices: tuple) -> None:
    """Refuse anything that is not one of ``choices``.

    Raises
    ------
    ValueError
        Naming the key, the value and the choices.
    """
    if value not in choices:
        raise ValueError(f"{key}: {value!r}; allowed: {', '.join(map(str, choices))}")
