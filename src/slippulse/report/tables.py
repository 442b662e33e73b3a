"""Tables of the report, as Markdown: ledger, sentences of the paper, errata, how exact the numbers are."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence

import pandas as pd

from ..claims import reading
from ..claims.reading import Ledger, claims_of, coverage, positions
from ..claims.rules import WORST_FIRST
from ..data.numerals import number, percent, setting, short, with_uncertainty
from .texts import ERRATUM, Line

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
    "all": "all",
}
# A long table stands between WIDE or SMALL and CLOSE: on pages on their side, or in small type over several pages.
# All figures so far stand before FLUSH.
OPEN = '`````{{=html}}\n<div class="wide">\n`````\n\n`````{{=typst}}\n#{}[\n`````'.format
WIDE, SMALL = map(OPEN, ("sideways", "small"))
CLOSE = "`````{=typst}\n]\n`````\n\n`````{=html}\n</div>\n`````"
FLUSH = "`````{=typst}\n#place.flush()\n`````"


def table(head: str, rows: Iterable[Sequence[object]]) -> str:
    """A pipe table of Markdown cells; ``head``: of each column title, side (l or r) and relative width."""
    columns = [column.strip().rpartition(" ") for column in head.split("|")]
    total = sum(int(form[1:]) for *_, form in columns)
    dashes = [(form[0], "-" * max(3, round(FULL * int(form[1:]) / total))) for *_, form in columns]
    marks = [f":{dash}" if side == "l" else f"{dash}:" for side, dash in dashes]
    lines = [[title for title, *_ in columns], marks, *rows]
    return "\n".join(
        "| " + " | ".join(" ".join(str(cell).split()) for cell in line) + " |" for line in lines
    )


def plain(text: str) -> str:
    """Text that Markdown and its tables leave alone."""
    return re.sub(r"([\\`*_{}\[\]<>#|$~^])", r"\\\1", text)


def code(names: Iterable[str]) -> str:
    """Names as code, one after the other."""
    return ", ".join(f"`{name}`" for name in names)


def verdicts(lines: Iterable[Line]) -> str:
    """The lines of the answer, each with its verdict as a link to the claim that it has it from."""
    link = "[{0.verdict}](../claims.html#{0.id})".format
    rows = [(line.topic, link(line.claim), line.text) for line in lines]
    return table("what the paper says l28 | verdict l16 | what was found l56", rows)


def failures(ledger: Ledger) -> str:
    """Every claim that is not simply reproduced, worst first, each with one sentence of why."""
    order = sorted(ledger, key=lambda claim: WORST_FIRST.index(claim.verdict))
    found = [claim for claim in order if claim.verdict != WORST_FIRST[-1]]
    rows = [(f"{claim.statement} `{claim.id}`", claim.verdict, claim.why) for claim in found]
    return table("claim l34 | verdict l13 | why l53", rows)


def whole_ledger(ledger: Ledger) -> str:
    """Every claim with its position in the paper, numbers, tolerance, verdict and note."""
    texts, rows = (reading.predicted_text, reading.measured_text, reading.compared_text), []
    for claim in ledger:
        what = f"{claim.statement} ({claim.figure_or_section}) `{claim.id}`"
        rows.append(
            (what, *(text(claim) for text in texts), claim.verdict, reading.evidence_text(claim))
        )
    head = "claim (section) `id` l32 | predicted r8 | measured r12 | deviation, tolerance l14"
    return table(f"{head} | verdict l9 | rests on l29", rows)


def tolerances(ledger: Ledger) -> str:
    """Why each tolerance is what it is: the claims that have kind, tolerance and reason in common together."""
    groups: dict[tuple[str, ...], list[str]] = {}
    for claim in ledger:
        exponent = getattr(claim, "tolerance_exponent", None)
        tolerance = setting(claim.tolerance) + (
            f"; exponent {setting(exponent)}" if exponent else ""
        )
        groups.setdefault((claim.kind, tolerance, plain(claim.reason)), []).append(claim.id)
    rows = [(*key, code(ids)) for key, ids in groups.items()]
    return table("kind l11 | tolerance r11 | reason l42 | claims l36", rows)


def algebra_checked(algebra: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> str:
    """Every piece of the paper's algebra that a test checks, with its position in the paper."""
    where = positions(algebra, sentences)
    rows = [(entry["statement"], where[id], code([id])) for id, entry in algebra.items()]
    return table("what the paper derives l60 | section l20 | id l20", rows)


def published(ledger: Ledger, readings: Mapping[str, Mapping]) -> str:
    """Numbers read off the published figure next to ours, with the reading error."""
    panels = ("published_space_time_figure", "published_space_time_figure_right")
    ours = {name: value for id in panels for name, value in ledger(id).further.items()}
    rows = []
    for each in readings.values():
        drawn = with_uncertainty(each["value"], each["reading_error"])
        rows.append((each["statement"], drawn, number(ours.get(each["statement"]), 5)))
    return table("quantity l50 | published r20 | this run r20", rows)


def found_list(ledger: Ledger) -> str:
    """Every finding, as a list."""
    return "\n".join(
        f"- {' '.join(finding['text'].split())}" for finding in ledger.findings.values()
    )


def sentence_counts(sentences: Sequence[Mapping]) -> str:
    """How many sentences are tested, and how many are not for each reason."""
    numbers = coverage(sentences)
    return table("sentences l60 | how many r15", [(REASONS[key], numbers[key]) for key in REASONS])


def tested_sentences(sentences: Sequence[Mapping], entries: Mapping[str, Mapping]) -> str:
    """Every sentence that is tested, with its position in the paper and its claims, among them the algebra."""
    rows = []
    for sentence in sentences:
        if claims := claims_of(entries, sentence):
            # For a narrow column: paragraph and sentence as numbers.
            position = re.sub(
                r", paragraph (\d+), sentence (\d+)", r", ¶ \1, \2", sentence["place"]
            )
            rows.append((position, sentence["paraphrase"], code(claims)))
    return table("section l22 | what it says l45 | claims l33", rows)


def errata(entries: Sequence[Mapping[str, str]], fill: Callable[[str], str]) -> str:
    """The errata, their expressions evaluated by ``fill``."""
    rows = [[fill(entry[key]) for key in ERRATUM] for entry in entries]
    return table("where l14 | printed l27 | right l33 | what shows it l26", rows)


def grid_studies(tables: Mapping[str, pd.DataFrame]) -> str:
    """Observed order and relative uncertainty of the main quantities, by the grid studies uncertainties/NAME."""
    rows = []
    for simulation, quantity, name in QUANTITIES:
        found = tables[f"uncertainties/{simulation}"]
        found = found[found["quantity"] == quantity]
        relative, orders = (
            (found["uncertainty"] / found["value"].abs()).dropna(),
            found["observed_order"],
        )
        order = number(orders.median(), 2) if len(relative) and orders.notna().any() else DASH
        off = [
            percent(size) if len(relative) else DASH for size in (relative.median(), relative.max())
        ]
        rows.append((name, len(relative) or len(found), order, *off))
    return table("quantity l40 | runs r10 | order r12 | median uncertainty r20 | largest r18", rows)


def sticking(examples: pd.DataFrame) -> str:
    """When positions x of an exact rupture are released and stick, and their slip; empty without a rupture."""
    columns = ["release_time", "stick_time", "final_slip"]
    found = examples[examples["quantity"].isin(columns)]
    if found["value"].isna().all():
        return ""
    numbers = found.pivot(index="x", columns="quantity", values="value")[columns]
    rows = [(setting(x), *(number(value, 5) for value in row)) for x, *row in numbers.itertuples()]
    head = r"$x$ r10 | release $T$ r15 | stick $t_\mathrm{s}$ r15 | slip $u(x,t_\mathrm{s})$ r15"
    return table(head, rows)


def edges(study: pd.DataFrame) -> str:
    """The edges of the solver's domain: what was compared, its error and tolerance, and how it ended."""
    rows = []
    for row in study.to_dict("records"):
        outcome = str(row["verdict"])
        # Behind a flag its name, which is the first word of the message.
        if outcome == "flagged":
            outcome += ": " + str(row["message"]).partition(",")[0].replace("_", " ")
        numbers = (
            "" if pd.isna(row[name]) else number(row[name], 2) for name in ("error", "tolerance")
        )
        rows.append((row["family"], plain(row["value"]), plain(row["quantity"]), *numbers, outcome))
    return table(
        "edge l16 | value l28 | compared l18 | error r12 | tolerance r12 | outcome l24", rows
    )


def alteration_note(altered: Iterable[Mapping], ledger: Ledger, verdicts: Mapping[str, str]) -> str:
    """What differs from the shipped configuration and its verdicts, as a quotation; empty if nothing does."""

    def literal(value: object) -> str:
        return "absent" if value is None else "`" + short(value).replace("`", "'") + "`"

    pair, lines = "`{}`: {} (shipped: {})".format, []
    keys = "; ".join(
        pair(each["key"], literal(each["here"]), literal(each["shipped"])) for each in altered
    )
    judged = [(claim.id, claim.verdict, verdicts.get(claim.id, "absent")) for claim in ledger]
    others = "; ".join(pair(*each) for each in judged if each[1] != each[2])
    if keys:
        lines = [
            f"> **Altered configuration.** This run differs from the shipped configuration in {keys}."
        ]
    if others:
        lines.append(f"> **Verdicts that differ from the shipped report:** {others}.")
    elif keys:
        lines.append("> No verdict differs from the shipped report.")
    return "\n>\n".join(lines)
