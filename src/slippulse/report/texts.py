"""The texts of the manuscript: captions and errata, refused where they are not whole."""

from __future__ import annotations

from collections.abc import Callable, Collection
from pathlib import Path
from typing import NamedTuple

import yaml

ERRATUM = ("where", "printed", "right", "shown")


class Caption(NamedTuple):
    """The texts of one figure.

    Attributes
    ----------
    title : a heading, plain text
    alt : what is seen, one plain sentence for who cannot see it
    finding : what the figure shows as a result, one sentence, Markdown
    caption : what is drawn, Markdown
    """

    title: str
    alt: str
    finding: str
    caption: str


PARTS = Caption._fields


def read_captions(path: str | Path, fill: Callable[[str], str] = str) -> dict[str, Caption]:
    """The captions of all figures by name, their expressions evaluated by ``fill``.

    Raises
    ------
    ValueError
        If a caption is not whole, naming the figure, the key, and what is allowed.
    """
    return {
        name: Caption(*(" ".join(fill(parts[key]).split()) for key in PARTS))
        for name, parts in _whole(path, read_text(path), PARTS).items()
    }


def read_errata(path: str | Path) -> list[dict[str, str]]:
    """The errata, mappings with the keys `ERRATUM`; one that is not whole is refused as a caption is."""
    entries = {f"entry {i}": entry for i, entry in enumerate(read_text(path), start=1)}
    return [*_whole(path, entries, ERRATUM).values()]


def read_text(path: str | Path):
    """A YAML file."""
    return yaml.safe_load(Path(path).read_text(encoding="utf-8"))


def _whole(path: str | Path, entries: dict[str, dict], keys: Collection[str]) -> dict[str, dict]:
    """Refuse an entry without a text for each key, or with another key."""
    for name, entry in entries.items():
        for key in [*entry, *keys]:
            if key not in keys:
                raise ValueError(f"{path}: {name}: {key}: unknown key; allowed: {', '.join(keys)}")
            if not str(entry.get(key) or "").strip():
                raise ValueError(f"{path}: {name}: {key}: missing; allowed: some text")
    return entries
