"""The texts of the manuscript: captions and errata, refused where they are not whole."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
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
    found = {}
    for name, parts in read_text(path).items():
        check_whole(f"{path}: {name}", parts, PARTS)
        found[name] = Caption(**{key: " ".join(fill(parts[key]).split()) for key in PARTS})
    return found


def read_errata(path: str | Path) -> list[dict[str, str]]:
    """The errata, mappings with the keys `ERRATUM`; one that is not whole is refused as a caption is."""
    entries = read_text(path)
    for i, entry in enumerate(entries, start=1):
        check_whole(f"{path}: entry {i}", entry, ERRATUM)
    return entries


def read_text(path: str | Path):
    """A YAML file."""
    return yaml.safe_load(Path(path).read_text(encoding="utf-8"))


def check_whole(where: str, entry: Mapping[str, str], keys: Collection[str]) -> None:
    """Refuse an entry without a text for each key, or with another key, by a ValueError that begins with ``where``."""
    for key in [*entry, *keys]:
        if key not in keys:
            raise ValueError(f"{where}: {key}: unknown key; allowed: {', '.join(keys)}")
        if not str(entry.get(key) or "").strip():
            raise ValueError(f"{where}: {key}: missing; allowed: some text")
