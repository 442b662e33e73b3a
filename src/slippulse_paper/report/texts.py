"""Read the texts in manuscript/*.yaml: captions, errata, and the answer with its verdicts.

The texts are templates, which contain expressions. The functions that read them take a function
``fill``, which replaces expressions by numbers. `judged_lines` and `statement_rows` also look up
the verdicts of the claims that a text names.
"""

from collections.abc import Callable, Collection, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import NamedTuple

from slippulse.model.scene import EXTRA_TERMS

from ..claims.claim_texts import read_text
from ..claims.ledger import Entry, Ledger
from ..claims.rules import WORST_FIRST
from ..text.numerals import MISSING, setting
from ..text.prose import without_missing

# The keys of an erratum. The text of `alters` names what the misprint changes in the paper.
ERRATUM = ("where", "printed", "right", "shown", "alters")
BOUNDARY_SYMBOLS = {"displacement": r"$\Gamma=1$", "stress": r"$\Gamma=0$"}
# The text of a line of the summary of which no number was measured.
NO_NUMBER = "This run has no number that decides."
# If there are more values than this, only the smallest and the largest are named.
MAX_LISTED_VALUES = 3


class VerdictWords(NamedTuple):
    """The words for a verdict in a sentence with one subject, and with several subjects."""

    verdict: str
    singular: str
    plural: str


# The answer has one sentence for each of these groups of verdicts.
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
    """The texts of a figure. Title and alternative text are plain; the others are Markdown."""

    title: str
    alt: str
    finding: str
    caption: str


def read_captions(path: str | Path, fill: Callable[[str], str] = str) -> dict[str, Caption]:
    """Return the captions of all figures by name, with their expressions evaluated by ``fill``.

    Raises ValueError if a caption lacks a text or has an unknown key.
    """
    captions = {}
    for name, parts in read_text(path).items():
        _check_keys(f"{path}: {name}", parts, Caption._fields)
        filled = {key: without_missing(" ".join(fill(text).split())) for key, text in parts.items()}
        captions[name] = Caption(**filled)
    return captions


def read_errata(path: str | Path) -> list[dict[str, str]]:
    """Return the errata, each of which is a mapping with the keys `ERRATUM`.

    Raises ValueError if an erratum lacks a text or has an unknown key.
    """
    entries = read_text(path)
    for i, entry in enumerate(entries, start=1):
        _check_keys(f"{path}: entry {i}", entry, ERRATUM)
    return entries


def _check_keys(label: str, entry: Mapping, keys: Collection[str]) -> None:
    """Raise ValueError if an entry lacks a text for one of the keys, or has an unknown key.

    label : words for the entry at the beginning of the error message
    """
    # The keys of the entry may be unknown, and the allowed keys may be missing.
    for key in [*entry, *keys]:
        if key not in keys:
            raise ValueError(f"{label}: {key}: unknown key; allowed: {', '.join(keys)}")
        if not str(entry.get(key) or "").strip():
            raise ValueError(f"{label}: {key}: missing; allowed: some text")


def listed(words: Sequence[str]) -> str:
    """Join words with commas, and the last two with "and"."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last


def parameters(config: Mapping, name: str, first: bool = False) -> str:
    """Return the parameters of a simulation in Markdown, such as "$\\Gamma=1$, $W$ = 1 and 2".

    Raises ValueError if the configuration does not have the simulation.

    name : name of the simulation
    first : if True, only the parameters of its first run are returned
    """
    if name not in config["simulations"]:
        raise ValueError(f"simulation: {name!r}; allowed: {', '.join(config['simulations'])}")
    simulation = config["simulations"][name]
    left = _profile_values(simulation, "left")
    right = _profile_values(simulation, "right")
    boundary = BOUNDARY_SYMBOLS[simulation["boundary"]]
    # The values of each parameter by its symbol. Parameters without values are left out at the end.
    values: dict[str, Sequence | None] = {r"$\gamma$": simulation.get("gamma")}
    values |= {f"${term.symbol}$": simulation.get(key) for key, term in EXTRA_TERMS.items()}
    if right == ["same"]:
        values[r"$\tau_0$"] = left
    else:
        values |= {r"$\tau_{0,l}$": left, r"$\tau_{0,r}$": right}
    # The pre-stress may have a step, beyond which it has other levels.
    values[r"then $\tau$"] = simulation.get("beyond", {}).get("levels")
    values["$W$"] = _profile_values(simulation, "width")
    # The damping is given either as beta or as the damping ratio b.
    values[r"$\beta$"] = simulation.get("beta")
    if not values[r"$\beta$"]:
        values["$b$"] = simulation.get("damping_ratio") or [config["model"]["damping_ratio"]]
    used = slice(1 if first else None)
    texts = [f"{symbol} = {_values_text(given[used])}" for symbol, given in values.items() if given]
    return ", ".join([boundary, *texts])


def _profile_values(simulation: Mapping, key: str) -> list:
    """Return the distinct values that the profiles of a simulation have for a key.

    A width of None, which stands for a profile without a Gaussian, is left out.

    key : a key of the pre-stress, such as "left"
    """
    values: list = []
    # A simulation without the key "profiles" is itself the only profile.
    for profile in simulation.get("profiles") or [simulation]:
        given = profile.get(key)
        values += given if isinstance(given, list) else [given]
    return [value for value in dict.fromkeys(values) if value is not None]


def _values_text(values: Sequence[float]) -> str:
    """Return values as text: a few of them as a list, and more as "smallest to largest"."""
    if len(values) > MAX_LISTED_VALUES:
        return f"{setting(min(values))} to {setting(max(values))}"
    return listed([setting(value) for value in sorted(values)])


class StatementRow(NamedTuple):
    """A row of the table on the index page: a statement of the paper, and what decides it."""

    statement: str
    claim: Entry  # the claim with the worst verdict, of those that test the statement
    number: str  # the number that decides it, with a few words


def statement_rows(
    summary: Mapping, ledger: Ledger, fill: Callable[[str], str]
) -> list[StatementRow]:
    """Return the rows of the table on the index page, with their expressions evaluated.

    A row that names several claims shows the one with the worst verdict.

    summary : content of manuscript/summary.yaml
    """
    rows = []
    for row in summary["statements"]:
        claim = worst_claim(ledger, row["claims"])
        # The number consists of phrases, of which those with a missing number are left out.
        phrases = fill(row["number"]).split("; ")
        measured = "; ".join(phrase for phrase in phrases if MISSING not in phrase)
        rows.append(StatementRow(fill(row["statement"]), claim, measured or MISSING))
    return rows


def worst_claim(ledger: Ledger, ids: Collection[str]) -> Entry:
    """Return the claim with the worst verdict; the first one if several are equally bad."""
    claims = [ledger(id) for id in ids]
    return min(claims, key=lambda claim: WORST_FIRST.index(claim.verdict))


class Line(NamedTuple):
    """An entry of the list `verdict` in manuscript/summary.yaml, with the verdicts of its claims.

    topic : heading of the line
    named : the topic as a part of a sentence
    text : what was found
    claim : the claim with the worst verdict, of those that count
    clause : a clause of the answer for this verdict; if it is empty, the answer uses `named`
    verdicts : for each verdict the first claim that has it, and the subjects of all such claims
    """

    topic: str
    named: str
    text: str
    claim: Entry
    clause: str
    verdicts: Sequence[tuple[Entry, str]]


def judged_lines(summary: Mapping, ledger: Ledger, fill: Callable[[str], str]) -> list[Line]:
    """Return the lines of the summary, with their verdicts, and with expressions evaluated.

    summary : content of manuscript/summary.yaml, whose list ``verdict`` has an entry for each line
    """
    lines = []
    for entry in summary["verdict"]:
        # The claim with the worst verdict decides the verdict of the line.
        worst = worst_claim(ledger, entry["claims"])
        # The text may have a clause of the answer for each verdict.
        clause_by_verdict = entry.get("said", {})
        # The subject of each claim by its id. Claims under "beside" are shown, but do not count.
        subjects = entry["claims"] | entry.get("beside", {})
        line = Line(
            topic=entry["topic"],
            named=entry["named"],
            text=without_missing(fill(entry["text"])) or NO_NUMBER,
            claim=worst,
            clause=fill(clause_by_verdict.get(worst.verdict, "")),
            verdicts=_first_claim_and_subjects_by_verdict(ledger, subjects),
        )
        lines.append(line)
    return lines


def _first_claim_and_subjects_by_verdict(
    ledger: Ledger, subjects: Mapping[str, str]
) -> list[tuple[Entry, str]]:
    """Return, for each verdict, the first claim that has it, and the subjects of all such claims.

    The subjects are a text in brackets. This text is empty if all claims have the same verdict.

    subjects : what each claim is about, by the id of the claim
    """
    ids_by_verdict: dict[str, list[str]] = {}
    for id in subjects:
        ids_by_verdict.setdefault(ledger(id).verdict, []).append(id)
    has_several_verdicts = len(ids_by_verdict) > 1
    verdicts = []
    for ids in ids_by_verdict.values():
        # Several claims may have the same subject.
        subject_list = listed([*dict.fromkeys(subjects[id] for id in ids)])
        text = f"({subject_list})" if has_several_verdicts else ""
        verdicts.append((ledger(ids[0]), text))
    return verdicts


def _opening(line: Line) -> str:
    """Return the first sentence of the answer, which begins with yes, no or not decided."""
    verdict = line.claim.verdict
    if verdict.startswith("reproduced"):
        return f"**Yes**: {line.named}."
    start = "No" if verdict == "not reproduced" else "Not decided"
    # Find the words for this verdict, such as "is not reproduced".
    predicate = {words.verdict: words.singular for words in chain.from_iterable(SENTENCES)}
    return f"**{start}**: the claim that {line.named} {predicate[verdict]}."


def answer(lines: Sequence[Line]) -> str:
    """Return the answer to the question of the summary as Markdown.

    The first sentence has the verdict on the first line. The other lines are named only if they are
    not simply reproduced, in one sentence for each group of verdicts in `SENTENCES`.
    """
    first_line, *other_lines = lines
    sentences = [_opening(first_line)]
    for group in SENTENCES:
        # Each entry of a group has the words for one verdict.
        clauses = []
        for words in group:
            judged = [line for line in other_lines if line.claim.verdict == words.verdict]
            clauses += _clauses(judged, words)
        if clauses:
            sentence = ", and ".join(clauses)
            sentences.append(f"{sentence[0].upper()}{sentence[1:]}.")
    return " ".join(sentences)


def _clauses(lines: Sequence[Line], words: VerdictWords) -> list[str]:
    """Return the clauses of the answer that report one verdict, such as "not reproduced".

    A line with a clause of its own contributes this clause. All other lines share one more clause,
    made from their topics (`Line.named`), such as "the width and the slip are different".

    lines : the lines of the summary that have this verdict
    words : the words for the verdict
    """
    clauses = [line.clause for line in lines if line.clause]
    subjects = [line.named for line in lines if not line.clause]
    if subjects:
        predicate = words.plural if len(subjects) > 1 else words.singular
        clauses.append(f"{listed(subjects)} {predicate}")
    return clauses
