"""Tables of the report, as Markdown: ledger, sentences of the paper, errata, and how exact the numbers are.

The cells of the report import them.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Mapping, Sequence

import pandas as pd

from ..claims.reading import (
    Ledger,
    claims_of,
    compared_text,
    coverage,
    evidence_text,
    measured_text,
    positions,
    predicted_text,
)
from ..claims.rules import WORST_FIRST
from ..data.numerals import number, percent, setting, short, with_uncertainty
from .answer import Line
from .texts import ERRATUM

# Wide enough that pandoc takes the dashes as relative widths.
FULL = 200
DASH = "\N{EM DASH}"
# What the grid table shows: simulation, column, name.
QUANTITIES = (
    ("steady_displacement", "front_speed_right", "front speed"),
    ("steady_displacement", "pulse_slip", "final slip"),
    ("steady_displacement", "pulse_peak_velocity", "peak slip velocity"),
    ("steady_displacement", "pulse_width", "pulse width"),
    ("scaling_displacement", "transition_time", r"$T_\mathrm{trans}$, displacement boundary"),
    ("scaling_displacement", "transition_length", r"$L_\mathrm{trans}$, displacement boundary"),
    ("scaling_stress", "transition_time", r"$T_\mathrm{trans}$, stress boundary"),
    ("scaling_stress", "transition_length", r"$L_\mathrm{trans}$, stress boundary"),
    ("scaling_stress", "last_release_time", "last release, stress boundary"),
)
# What a reason reads like in a table of how many sentences have it.
REASONS = {
    "tested": "tested by a claim",
    "repeats": "repeats another sentence",
    "background": "background, or says no more than that something is shown",
    "definition": "definition or assumption",
    "other work": "is about other work",
    "no model": "no model here can tell",
}


def _between(typst: str) -> str:
    return f'`````{{=html}}\n<div class="wide">\n`````\n\n`````{{=typst}}\n#{typst}[\n`````'


# A long table stands between WIDE or SMALL and CLOSE: on pages on their side, or in small type over several pages.
# All figures so far stand before FLUSH.
WIDE, SMALL = _between("sideways"), _between("small")
CLOSE = "`````{=typst}\n]\n`````\n\n`````{=html}\n</div>\n`````"
FLUSH = "`````{=typst}\n#place.flush()\n`````"


def table(head: Sequence[str], rows: Iterable[Sequence[str]], widths: Sequence[int], align: str) -> str:
    """A pipe table of Markdown cells without bare bars; one relative width and one letter, l or r, a column."""
    marks = []
    for width, side in zip(widths, align, strict=True):
        dashes = "-" * max(3, round(FULL * width / sum(widths)))
        marks.append(f":{dashes}" if side == "l" else f"{dashes}:")
    lines = [head, marks, *rows]
    return "\n".join("| " + " | ".join(" ".join(str(cell).split()) for cell in line) + " |" for line in lines)


def plain(text: str) -> str:
    """Text that Markdown and its tables leave alone."""
    return re.sub(r"([\\`*_{}\[\]<>#|$~^])", r"\\\1", text)


def verdicts(lines: Iterable[Line]) -> str:
    """The lines of the answer, each with its verdict as a link to the claim that it has it from."""
    rows = [
        [line.topic, f"[{line.claim.verdict}](../claims.html#{line.claim.id})", line.text] for line in lines
    ]
    return table(["what the paper says", "verdict", "what was found"], rows, [28, 16, 56], "lll")


def failures(ledger: Ledger) -> str:
    """Every claim that is not simply reproduced, worst first, each with one sentence of why."""
    rows = [
        [f"{claim.statement} `{claim.id}`", claim.verdict, claim.why]
        for verdict in WORST_FIRST[:-1]
        for claim in ledger
        if claim.verdict == verdict
    ]
    return table(["claim", "verdict", "why"], rows, [34, 13, 53], "lll")


def whole_ledger(ledger: Ledger) -> str:
    """Every claim with its position in the paper, numbers, tolerance, verdict and note."""
    rows = [
        [
            f"{claim.statement} ({claim.figure_or_section}) `{claim.id}`",
            predicted_text(claim),
            measured_text(claim),
            compared_text(claim),
            claim.verdict,
            evidence_text(claim),
        ]
        for claim in ledger
    ]
    head = ["claim (section) `id`", "predicted", "measured", "deviation, tolerance", "verdict", "rests on"]
    return table(head, rows, [32, 8, 12, 14, 9, 29], "lrrlll")


def tolerances(ledger: Ledger) -> str:
    """Why each tolerance is what it is: the claims that have kind, tolerance and reason in common together."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for claim in ledger:
        exponent = getattr(claim, "tolerance_exponent", None)
        tolerance = setting(claim.tolerance) + (f"; exponent {setting(exponent)}" if exponent else "")
        key = (claim.kind, tolerance, plain(claim.reason))
        groups.setdefault(key, []).append(f"`{claim.id}`")
    rows = [[*key, ", ".join(ids)] for key, ids in groups.items()]
    return table(["kind", "tolerance", "reason", "claims"], rows, [11, 11, 42, 36], "lrll")


def algebra_checked(algebra: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> str:
    """Every piece of the paper's algebra that a test checks, with its position in the paper."""
    where = positions(algebra, sentences)
    rows = [[entry["statement"], where[id], f"`{id}`"] for id, entry in algebra.items()]
    return table(["what the paper derives", "section", "id"], rows, [60, 20, 20], "lll")


def published(ledger: Ledger, readings: Mapping[str, Mapping]) -> str:
    """Numbers read off the published figure next to ours, with the reading error."""
    panels = ("published_space_time_figure", "published_space_time_figure_right")
    ours = {name: value for id in panels for name, value in ledger(id).further.items()}
    rows = [
        [
            each["statement"],
            with_uncertainty(each["value"], each["reading_error"]),
            number(ours.get(each["statement"]), 5),
        ]
        for each in readings.values()
    ]
    return table(["quantity", "published", "this run"], rows, [50, 20, 20], "lrr")


def found_list(ledger: Ledger) -> str:
    """Every finding, as a list."""
    return "\n".join(f"- {' '.join(finding['text'].split())}" for finding in ledger.findings.values())


def sentence_counts(sentences: Sequence[Mapping]) -> str:
    """How many sentences are tested, and how many are not for each reason."""
    numbers = coverage(sentences)
    rows = [[words, str(numbers[key])] for key, words in REASONS.items()]
    return table(["sentences", "how many"], [*rows, ["all", str(numbers["all"])]], [60, 15], "lr")


def tested_sentences(sentences: Sequence[Mapping], entries: Mapping[str, Mapping]) -> str:
    """Every sentence that is tested, with its position in the paper and its claims, among them the algebra."""
    rows = []
    for sentence in sentences:
        if claims := claims_of(entries, sentence):
            # For a narrow column: paragraph and sentence as numbers.
            position = re.sub(r", paragraph (\d+), sentence (\d+)", r", ¶ \1, \2", sentence["place"])
            rows.append([position, sentence["paraphrase"], ", ".join(f"`{claim}`" for claim in claims)])
    return table(["section", "what it says", "claims"], rows, [22, 45, 33], "lll")


def errata(entries: Sequence[Mapping[str, str]], fill: Callable[[str], str]) -> str:
    """The errata, their expressions evaluated by ``fill``."""
    rows = [[fill(entry[key]) for key in ERRATUM] for entry in entries]
    return table(["where", "printed", "right", "what shows it"], rows, [14, 27, 33, 26], "llll")


def grid_studies(tables: Mapping[str, pd.DataFrame]) -> str:
    """Observed order and relative uncertainty of the main quantities, by the grid studies uncertainties/NAME."""
    rows = []
    for simulation, quantity, name in QUANTITIES:
        found = tables[f"uncertainties/{simulation}"]
        found = found[found["quantity"] == quantity]
        relative = (found["uncertainty"] / found["value"].abs()).dropna()
        orders = found["observed_order"].dropna()
        runs = len(relative) or len(found)
        order = number(orders.median(), 2) if len(orders) and len(relative) else DASH
        off = [percent(size) if len(relative) else DASH for size in (relative.median(), relative.max())]
        rows.append([name, str(runs), order, *off])
    head = ["quantity", "runs", "order", "median uncertainty", "largest"]
    return table(head, rows, [40, 10, 12, 20, 18], "lrrrr")


def sticking(examples: pd.DataFrame) -> str:
    """When positions x of an exact rupture are released and stick, and their slip; empty without a rupture."""
    columns = ["release_time", "stick_time", "final_slip"]
    found = examples[examples["quantity"].isin(columns)]
    if found["value"].isna().all():
        return ""
    numbers = found.pivot(index="x", columns="quantity", values="value")[columns]
    rows = [[setting(x), *(number(value, 5) for value in row)] for x, *row in numbers.itertuples()]
    head = ["$x$", r"release $T$", r"stick $t_\mathrm{s}$", r"slip $u(x,t_\mathrm{s})$"]
    return table(head, rows, [10, 15, 15, 15], "rrrr")


def edges(study: pd.DataFrame) -> str:
    """The edges of the solver's domain: what was compared, its error and tolerance, and how it ended."""
    rows = []
    for row in study.to_dict("records"):
        outcome = str(row["verdict"])
        # Behind a flag its name, which is the first word of the message.
        if outcome == "flagged":
            outcome += ": " + str(row["message"]).partition(",")[0].replace("_", " ")
        numbers = ["" if pd.isna(row[name]) else number(row[name], 2) for name in ("error", "tolerance")]
        rows.append([row["family"], plain(row["value"]), plain(row["quantity"]), *numbers, outcome])
    head = ["edge", "value", "compared", "error", "tolerance", "outcome"]
    return table(head, rows, [16, 28, 18, 12, 12, 24], "lllrrl")


def alteration_note(altered: Iterable[Mapping], ledger: Ledger, verdicts: Mapping[str, str]) -> str:
    """What differs from the shipped configuration and its verdicts, as a quotation; empty if nothing does."""

    def code(value: object) -> str:
        return "absent" if value is None else "`" + short(value).replace("`", "'") + "`"

    keys = [
        f"`{change['key']}`: {code(change['here'])} (shipped: {code(change['shipped'])})"
        for change in altered
    ]
    judged = [
        f"`{claim.id}`: {claim.verdict} (shipped: {verdicts.get(claim.id, 'absent')})"
        for claim in ledger
        if claim.verdict != verdicts.get(claim.id)
    ]
    lines = []
    if keys:
        lines.append(
            f"> **Altered configuration.** This run differs from the shipped configuration in {'; '.join(keys)}."
        )
    if judged:
        lines.append(f"> **Verdicts that differ from the shipped report:** {'; '.join(judged)}.")
    elif keys:
        lines.append("> No verdict differs from the shipped report.")
    return "\n>\n".join(lines)
