"""The texts in manuscript/*.yaml: captions, errata, and the answer with its verdicts.

The texts are templates. Each reader fills in the numbers of one run, and `judged_lines` and
`statement_rows` look up the verdicts of the claims that a text names.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import NamedTuple

from slippulse.model.scene import EXTRA_TERMS

from ..claims.claim_texts import read_text
from ..claims.ledger import Entry, Ledger
from ..claims.rules import WORST_FIRST
from ..text.numerals import setting

# The parts of an erratum. `alters` names what the error changes in the paper.
ERRATUM = ("where", "printed", "right", "shown", "alters")
BOUNDARY_SYMBOLS = {"displacement": r"$\Gamma=1$", "stress": r"$\Gamma=0$"}
# A list of more values than this is shortened to its smallest and largest value.
MAX_LISTED_VALUES = 3


class VerdictWords(NamedTuple):
    """The words for a verdict in the answer, after one subject and after several."""

    verdict: str
    singular: str
    plural: str


# Each group of verdicts gets one sentence of the answer.
SENTENCES = (
    (
        VerdictWords(
            "depends on an open choice",
            "depends on choices that the paper leaves open",
            "depend on choices that the paper leaves open",
        ),
    ),
    (
        VerdictWords("not reproduced", "is not reproduced", "are not reproduced"),
        VerdictWords("premise not met", "is not met", "are not met"),
        VerdictWords("different beyond the paper", "is different", "are different"),
    ),
    (VerdictWords("inconclusive", "stays open", "stay open"),),
    (VerdictWords("not testable", "is not tested in this run", "are not tested in this run"),),
)


class Caption(NamedTuple):
    """The texts of a figure: title and alternative text are plain, the others Markdown."""

    title: str
    alt: str
    finding: str
    caption: str


def read_captions(path: str | Path, fill: Callable[[str], str] = str) -> dict[str, Caption]:
    """Read the captions of all figures by name, and evaluate their expressions with ``fill``.

    Raises ValueError if a caption lacks a text or has an unknown key.
    """
    captions = {}
    for name, parts in read_text(path).items():
        _check_keys(f"{path}: {name}", parts, Caption._fields)
        filled = {key: " ".join(fill(text).split()) for key, text in parts.items()}
        captions[name] = Caption(**filled)
    return captions


def read_errata(path: str | Path) -> list[dict[str, str]]:
    """Read the errata, each a mapping with the keys `ERRATUM`; ValueError if one is incomplete."""
    entries = read_text(path)
    for i, entry in enumerate(entries, start=1):
        _check_keys(f"{path}: entry {i}", entry, ERRATUM)
    return entries


def _check_keys(label: str, entry: Mapping, keys: Collection[str]) -> None:
    """Raise ValueError if an entry lacks a text for one of the keys, or has an unknown key."""
    for key in [*entry, *keys]:
        if key not in keys:
            raise ValueError(f"{label}: {key}: unknown key; allowed: {', '.join(keys)}")
        if not str(entry.get(key) or "").strip():
            raise ValueError(f"{label}: {key}: missing; allowed: some text")


def listed(words: Sequence[str]) -> str:
    """Join words with commas, and the last two with "and"."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def parameters(config: Mapping, name: str) -> str:
    """Return the parameters of a simulation in Markdown, such as "$\\Gamma=1$, $W$ = 1 and 2".

    Raises ValueError for a simulation that the configuration does not have.
    """
    if name not in config["simulations"]:
        raise ValueError(f"simulation: {name!r}; allowed: {', '.join(config['simulations'])}")
    simulation = config["simulations"][name]
    left = _profile_values(simulation, "left")
    right = _profile_values(simulation, "right")
    boundary = BOUNDARY_SYMBOLS[simulation["boundary"]]
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
    parts = [f"{symbol} = {_values_text(given)}" for symbol, given in values.items() if given]
    return ", ".join([boundary, *parts])


def _profile_values(simulation: Mapping, key: str) -> list:
    """Return the distinct values of one key of the pre-stress over the profiles of a simulation."""
    values: list = []
    # A simulation without profiles has the keys of a profile itself.
    for profile in simulation.get("profiles") or [simulation]:
        given = profile.get(key, [])
        values += given if isinstance(given, list) else [given]
    return [*dict.fromkeys(values)]


def _values_text(values: Sequence[float]) -> str:
    """Write a few values as a list, and more of them as "smallest to largest"."""
    if len(values) > MAX_LISTED_VALUES:
        return f"{setting(min(values))} to {setting(max(values))}"
    return listed([setting(value) for value in sorted(values)])


class StatementRow(NamedTuple):
    """A row of the table on the index: a statement of the paper and what decides it."""

    statement: str
    # The claim with the worst verdict.
    claim: Entry
    number: str


def statement_rows(
    summary: Mapping, ledger: Ledger, fill: Callable[[str], str]
) -> list[StatementRow]:
    """Return the rows of the index in the order of the summary, with expressions evaluated."""
    rows = []
    for row in summary["statements"]:
        claim = worst_claim(ledger, row["claims"])
        rows.append(StatementRow(fill(row["statement"]), claim, fill(row["number"])))
    return rows


def worst_claim(ledger: Ledger, ids: Collection[str]) -> Entry:
    """Return the claim with the worst verdict; the first one if several are equally bad."""
    claims = [ledger(id) for id in ids]
    return min(claims, key=lambda claim: WORST_FIRST.index(claim.verdict))


class Line(NamedTuple):
    """A line under `verdict` in manuscript/summary.yaml, with the verdicts of its claims."""

    topic: str
    # The topic as a sentence names it.
    named: str
    text: str
    # The claim with the worst verdict among those that count.
    claim: Entry
    # The clause of the answer for that verdict; empty if `named` serves.
    clause: str
    # One claim for each verdict, with the subjects that have this verdict in brackets. The subjects
    # are empty if all claims have the same verdict.
    verdicts: Sequence[tuple[Entry, str]]


def judged_lines(summary: Mapping, ledger: Ledger, fill: Callable[[str], str]) -> list[Line]:
    """Return the lines of the summary in their order, with expressions evaluated by ``fill``."""
    lines = []
    for entry in summary["verdict"]:
        worst = worst_claim(ledger, entry["claims"])
        clause = fill(entry.get("said", {}).get(worst.verdict, ""))
        subjects = entry["claims"] | entry.get("beside", {})
        verdicts = _claims_by_verdict(ledger, subjects)
        text = fill(entry["text"])
        lines.append(Line(entry["topic"], entry["named"], text, worst, clause, verdicts))
    return lines


def _claims_by_verdict(ledger: Ledger, subjects: Mapping[str, str]) -> list[tuple[Entry, str]]:
    """Return, for each verdict, its first claim and the subjects of all claims that have it.

    subjects : what each claim is about, by the id of the claim
    """
    ids_by_verdict: dict[str, list[str]] = {}
    for id in subjects:
        ids_by_verdict.setdefault(ledger(id).verdict, []).append(id)
    several = len(ids_by_verdict) > 1
    verdicts = []
    for ids in ids_by_verdict.values():
        words = listed([*dict.fromkeys(subjects[id] for id in ids)])
        verdicts.append((ledger(ids[0]), f"({words})" if several else ""))
    return verdicts


def _opening(line: Line) -> str:
    """Return the first sentence of the answer: yes, no or not decided."""
    verdict = line.claim.verdict
    if verdict.startswith("reproduced"):
        return f"**Yes**: {line.named}."
    start = "No" if verdict == "not reproduced" else "Not decided"
    singular = {words.verdict: words.singular for words in chain.from_iterable(SENTENCES)}
    return f"**{start}**: that {line.named}, {singular[verdict]}."


def answer(lines: Sequence[Line]) -> str:
    """Return the answer to the question of the summary as Markdown.

    Its first sentence reports the verdict on the first line. One sentence for each group of
    verdicts in `SENTENCES` names the other lines that are not simply reproduced.
    """
    first, *rest = lines
    sentences = [_opening(first)]
    for group in SENTENCES:
        clauses = []
        for words in group:
            judged = [line for line in rest if line.claim.verdict == words.verdict]
            clauses += [line.clause for line in judged if line.clause]
            subjects = [line.named for line in judged if not line.clause]
            if subjects:
                predicate = words.plural if len(subjects) > 1 else words.singular
                clauses.append(f"{listed(subjects)} {predicate}")
        if clauses:
            sentence = ", and ".join(clauses)
            sentences.append(f"{sentence[0].upper()}{sentence[1:]}.")
    return " ".join(sentences)
