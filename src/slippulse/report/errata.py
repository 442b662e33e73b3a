"""The errata as data: place, what is printed, what is right, what shows it."""

from __future__ import annotations

from collections.abc import Callable

from .markdown import table

KEYS = ("place", "printed", "right", "shown")


def check_errata(entries: list[dict]) -> None:
    """Refuse an entry that is not whole.

    Raises
    ------
    ValueError
        Naming the entry, the key, and what is allowed.
    """
    for i, entry in enumerate(entries, start=1):
        for key in KEYS:
            if not str(entry.get(key) or "").strip():
                raise ValueError(f"errata, entry {i}: {key}: missing; allowed: some text")
        unknown = set(entry) - set(KEYS)
        if unknown:
            raise ValueError(f"errata, entry {i}: {min(unknown)}: unknown key; allowed: {', '.join(KEYS)}")


def errata_table(entries: list[dict], fill: Callable[[str], str]) -> str:
    """The table.

    Parameters
    ----------
    entries : mappings with the keys `KEYS`, Markdown
    fill : evaluates the expressions in an entry
    """
    check_errata(entries)
    rows = [[fill(entry[key]) for key in KEYS] for entry in entries]
    return table(["place", "printed", "right", "what shows it"], rows, [14, 27, 33, 26], "llll")
