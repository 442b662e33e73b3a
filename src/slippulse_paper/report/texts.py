"""Texts of the manuscript: captions, errata, the parameters of a simulation, and the answer."""

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from slippulse.model.scene import EXTRA_TERMS

from ..claims.claim_texts import read_text
from ..claims.ledger import Entry, Ledger
from ..claims.rules import WORST_FIRST
from ..text.numerals import setting

# What an erratum has: `alters` says what changes by it.
ERRATUM = ("where", "printed", "right", "shown", "alters")
# A text names only the ends of more values than this.
FEW = 3
# Verdicts that one sentence of the answer names together, each with the words for one thing that
# has it, and for several.
SENTENCES = (
    {
        "depends on an open choice": (
            "depends on choices that the paper leaves open",
            "depend on choices that the paper leaves open",
        )
    },
    {
        "not reproduced": ("is not reproduced", "are not reproduced"),
        "premise not met": ("is not met", "are not met"),
        "different beyond the paper": ("is different", "are different"),
    },
    {"inconclusive": ("stays open", "stay open")},
    {"not testable": ("is not tested in this run", "are not tested in this run")},
)


class Caption(NamedTuple):
    """Texts of a figure: title and alternative text, plain; finding and caption, Markdown."""

    title: str
    alt: str
    finding: str
    caption: str


def read_captions(path: str | Path, fill: Callable[[str], str] = str) -> dict[str, Caption]:
    """Captions by name of the figure, their expressions evaluated by ``fill``; or ValueError."""
    captions = {}
    for name, parts in read_text(path).items():
        _check_keys(f"{path}: {name}", parts, Caption._fields)
        filled = {key: " ".join(fill(text).split()) for key, text in parts.items()}
        captions[name] = Caption(**filled)
    return captions


def read_errata(path: str | Path) -> list[dict[str, str]]:
    """The errata, mappings with the keys `ERRATUM`; or ValueError."""
    entries = read_text(path)
    for i, entry in enumerate(entries, start=1):
        _check_keys(f"{path}: entry {i}", entry, ERRATUM)
    return entries


def _check_keys(label: str, entry: Mapping, keys: Collection[str]) -> None:
    """Refuse an entry without a text for each key, or with another key."""
    for key in [*entry, *keys]:
        if key not in keys:
            raise ValueError(f"{label}: {key}: unknown key; allowed: {', '.join(keys)}")
        if not str(entry.get(key) or "").strip():
            raise ValueError(f"{label}: {key}: missing; allowed: some text")


def listed(words: Sequence[str]) -> str:
    """Words, the last two joined by "and"."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def parameters(config: Mapping, name: str) -> str:
    """Boundary, elasticity ratio, pre-stress and damping of a simulation's runs, as Markdown."""
    if name not in config["simulations"]:
        raise ValueError(f"simulation: {name!r}; allowed: {', '.join(config['simulations'])}")
    simulation = config["simulations"][name]
    left, right = _profile_values(simulation, "left"), _profile_values(simulation, "right")
    boundary = {"displacement": r"$\Gamma=1$", "stress": r"$\Gamma=0$"}[simulation["boundary"]]
    values: dict[str, Sequence | None] = {r"$\gamma$": simulation.get("gamma")}
    values |= {f"${term.symbol}$": simulation.get(name) for name, term in EXTRA_TERMS.items()}
    if right == ["same"]:
        values[r"$\tau_0$"] = left
    else:
        values |= {r"$\tau_{0,l}$": left, r"$\tau_{0,r}$": right}
    values[r"then $\tau$"] = simulation.get("beyond", {}).get("levels")
    values["$W$"] = _profile_values(simulation, "width")
    values[r"$\beta$"] = simulation.get("beta")
    if not values[r"$\beta$"]:
        values["$b$"] = simulation.get("damping_ratio") or [config["model"]["damping_ratio"]]
    parts = [f"{symbol} = {_values(numbers)}" for symbol, numbers in values.items() if numbers]
    return ", ".join([boundary, *parts])


def _profile_values(simulation: Mapping, key: str) -> list:
    """Different values of one key of the pre-stress, which profiles or lists have."""
    values: list = []
    for part in simulation.get("profiles") or [simulation]:
        given = part.get(key, [])
        values += given if isinstance(given, list) else [given]
    return [*dict.fromkeys(values)]


def _values(values: Sequence[float]) -> str:
    if len(values) > FEW:
        return f"{setting(min(values))} to {setting(max(values))}"
    return listed([setting(value) for value in sorted(values)])


class Line(NamedTuple):
    """A line of manuscript/summary.yaml, judged by claims."""

    topic: str
    named: str
    text: str
    # The worst of the claims that decide it, and the clause of the answer for its verdict, if any.
    claim: Entry
    said: str
    # A claim of each verdict, those told beside included, with what has it if there are several.
    verdicts: Sequence[tuple[Entry, str]]


def judged_lines(summary: Mapping, ledger: Ledger, fill: Callable[[str], str]) -> list[Line]:
    """The lines of the summary in their order, their expressions evaluated by ``fill``."""
    lines = []
    for entry in summary["verdict"]:
        claims = [ledger(id) for id in entry["claims"]]
        worst = min(claims, key=lambda claim: WORST_FIRST.index(claim.verdict))
        said = fill(entry.get("said", {}).get(worst.verdict, ""))
        names = entry["claims"] | entry.get("beside", {})
        groups: dict[str, list[str]] = {}
        for id in names:
            groups.setdefault(ledger(id).verdict, []).append(id)
        told = []
        for ids in groups.values():
            words = listed([*dict.fromkeys(names[id] for id in ids)])
            told.append((ledger(ids[0]), f"({words})" if len(groups) > 1 else ""))
        lines.append(Line(entry["topic"], entry["named"], fill(entry["text"]), worst, said, told))
    return lines


def _opening(line: Line) -> str:
    """The first sentence of the answer: yes, no or not decided."""
    verdict = line.claim.verdict
    if verdict.startswith("reproduced"):
        return f"**Yes**: {line.named}."
    start = "No" if verdict == "not reproduced" else "Not decided"
    clause = next(said[verdict][0] for said in SENTENCES if verdict in said)
    return f"**{start}**: that {line.named}, {clause}."


def answer(lines: Sequence[Line]) -> str:
    """Sentences of Markdown: whether the first line is reproduced, and which others are not."""
    first, *rest = lines
    sentences = [_opening(first)]
    for verdicts in SENTENCES:
        clauses = []
        for verdict, (singular, plural) in verdicts.items():
            these = [line for line in rest if line.claim.verdict == verdict]
            clauses += [line.said for line in these if line.said]
            named = [line.named for line in these if not line.said]
            if named:
                clauses.append(f"{listed(named)} {plural if len(named) > 1 else singular}")
        if clauses:
            words = ", and ".join(clauses)
            sentences.append(f"{words[0].upper()}{words[1:]}.")
    return " ".join(sentences)
