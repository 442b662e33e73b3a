"""The captions of the figures, written once: title, finding, what is drawn, and what is seen in words."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import yaml

PARTS = ("title", "alt", "finding", "caption")


@dataclass(frozen=True)
class Caption:
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


def read_captions(path: str | Path, fill: Callable[[str], str] = str) -> dict[str, Caption]:
    """The captions of all figures.

    Parameters
    ----------
    path : YAML, per figure the keys `PARTS`
    fill : evaluates the expressions in a text

    Raises
    ------
    ValueError
        If a caption is not whole, naming the figure, the key, and what is allowed.
    """
    found = {}
    for name, parts in yaml.safe_load(Path(path).read_text(encoding="utf-8")).items():
        for key in {*parts, *PARTS}:
            if key not in PARTS:
                raise ValueError(f"{path}: {name}: {key}: unknown key; allowed: {', '.join(PARTS)}")
            if not str(parts.get(key) or "").strip():
                raise ValueError(f"{path}: {name}: {key}: missing; allowed: some text")
        found[name] = Caption(**{key: " ".join(fill(parts[key]).split()) for key in PARTS})
    return found
