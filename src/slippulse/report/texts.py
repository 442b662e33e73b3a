"""The texts of the manuscript: captions, errata, the parameters of a simulation in words, and the answer."""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from itertools import chain
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple

from ..claims.reading import Ledger, read_text
from ..claims.rules import WORST_FIRST
from ..data.numerals import setting

ERRATUM = ("where", "printed", "right", "shown")
# Of more values than this only the ends are named.
FEW = 3
# What the answer says of one thing with each verdict, and of several.
EXCEPTIONS = {
    "not reproduced": ("is not reproduced", "are not reproduced"),
    "depends on an open choice": (
        "depends on a choice that the paper leaves open",
        "depend on choices that the paper leaves open",
    ),
    "inconclusive": ("stays open", "stay open"),
    "not testable": ("is not tested in this run", "are not tested in this run"),
}


class Caption(NamedTuple):
    """Texts of a figure: plain title and alt; in Markdown the finding, what it shows, and what is drawn."""

    title: str
    alt: str
    finding: str
    caption: str


PARTS = Caption._fields


def read_captions(path: str | Path, fill: Callable[[str], str] = str) -> dict[str, Caption]:
    """The captions of all figures by name, their expressions evaluated by ``fill``; ValueError if one is not whole."""
    return {
        name: Caption(*(" ".join(fill(parts[key]).split()) for key in PARTS))
        for name, parts in _whole(path, read_text(path), PARTS).items()
    }


def read_errata(path: str | Path) -> list[dict[str, str]]:
    """The errata, mappings with the keys `ERRATUM`; one that is not whole is refused as a caption is."""
    entries = {f"entry {i}": entry for i, entry in enumerate(read_text(path), start=1)}
    return [*_whole(path, entries, ERRATUM).values()]


def _whole(path: str | Path, entries: dict[str, dict], keys: Collection[str]) -> dict[str, dict]:
    """Refuse an entry without a text for each key, or with another key."""
    for name, entry in entries.items():
        for key in [*entry, *keys]:
            if key not in keys:
                raise ValueError(f"{path}: {name}: {key}: unknown key; allowed: {', '.join(keys)}")
            if not str(entry.get(key) or "").strip():
                raise ValueError(f"{path}: {name}: {key}: missing; allowed: some text")
    return entries


def listed(words: Sequence[str]) -> str:
    """Words, the last two joined by "and"."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def parameters(config: Mapping, name: str) -> str:
    """Boundary, elasticity ratio, pre-stress and damping of all runs of one of its simulations, as Markdown."""
    if name not in config["simulations"]:
        raise ValueError(f"simulation: {name!r}; allowed: {', '.join(config['simulations'])}")
    simulation = config["simulations"][name]
    profiles = simulation.get("profiles") or [simulation]
    # Of lists, single values or missing.
    given = ([each[key] for each in profiles if key in each] for key in ("left", "right", "width"))
    lists = ([one if isinstance(one, list) else [one] for one in found] for found in given)
    left, right, width = ([*dict.fromkeys(chain.from_iterable(found))] for found in lists)
    springs, same = simulation["boundary"] == "displacement", right == ["same"]
    ratios = simulation.get("damping_ratio") or [config["model"]["damping_ratio"]]
    values = {
        r"$\gamma$": simulation["gamma"] if springs else [],
        r"$\tau_0$" if same else r"$\tau_{0,l}$": left,
        r"$\tau_{0,r}$": [] if same else right,
        r"then $\tau$": simulation.get("beyond", {}).get("levels"),
        "$W$": width,
        r"$\beta$": simulation.get("beta"),
        "$b$": [] if "beta" in simulation else ratios,
    }
    parts = [f"{symbol} = {_values(found)}" for symbol, found in values.items() if found]
    return ", ".join([r"$\Gamma=1$" if springs else r"$\Gamma=0$", *parts])


def _values(values: Sequence[float]) -> str:
    if len(values) > FEW:
        return f"{setting(min(values))} to {setting(max(values))}"
    return listed([setting(value) for value in sorted(values)])


class Line(NamedTuple):
    """One thing that the paper says, as in manuscript/summary.yaml, with the worst of the claims that it rests on."""

    topic: str
    named: str
    text: str
    claim: SimpleNamespace


def judged_lines(summary: Mapping, ledger: Ledger, fill: Callable[[str], str]) -> list[Line]:
    """The lines of the summary in their order, their expressions evaluated by ``fill``."""

    def worst(claims: Iterable[str]) -> SimpleNamespace:
        return min(map(ledger, claims), key=lambda claim: WORST_FIRST.index(claim.verdict))

    return [
        Line(it["topic"], it["named"], fill(it["text"]), worst(it["claims"]))
        for it in summary["verdict"]
    ]


def answer(lines: Sequence[Line]) -> str:
    """One sentence: whether what the first line says is reproduced, and which of the others are not, as Markdown."""
    first, *rest = lines
    parts = []
    for verdict, says in EXCEPTIONS.items():
        if named := [line.named for line in rest if line.claim.verdict == verdict]:
            parts.append(f"{listed(named)} {says[len(named) > 1]}")
    start = "Yes" if first.claim.verdict.startswith("reproduced") else "Not in this run"
    return f"**{start}**, {first.named}{', except that ' if parts else ''}{', and '.join(parts)}."
