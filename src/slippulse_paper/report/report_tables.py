"""Write the tables of the report as Markdown: claims, sentences of the paper, errata, accuracy."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence

import pandas as pd

from ..claims.claim_texts import REASONS, claims_of, coverage, places_of
from ..claims.ledger import Ledger
from ..claims.rules import WORST_FIRST
from ..text.numerals import number, percent, setting, short, with_uncertainty
from .texts import ERRATUM, Line

# In lines of this length, pandoc reads the dashes of a pipe table as relative column widths.
LINE_LENGTH = 200
DASH = "\N{EM DASH}"
# Rows of the table of grid studies: simulation, column, name in the table.
STUDIED_QUANTITIES = (
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
# Markers around a long table: WIDE and CLOSE put it on landscape pages, SMALL and CLOSE set it in
# small type over several pages. FLUSH places all earlier figures before the text that follows.
OPEN = '`````{{=html}}\n<div class="wide">\n`````\n\n`````{{=typst}}\n#{}[\n`````'.format
WIDE, SMALL = map(OPEN, ("sideways", "small"))
CLOSE = "`````{=typst}\n]\n`````\n\n`````{=html}\n</div>\n`````"
FLUSH = "`````{=typst}\n#place.flush()\n`````"
# Figures after BELOW go to the bottom of a page, so that none interrupts the table before it.
BELOW = "`````{=typst}\n#show figure.where(kind: image): set figure(placement: bottom)\n`````"


def table(head: str, rows: Iterable[Sequence[object]]) -> str:
    """Return a pipe table in Markdown.

    head : title, alignment (l or r) and relative width of each column: "claim l34 | runs r10"
    """
    columns = [column.strip().rpartition(" ") for column in head.split("|")]
    total = sum(int(form[1:]) for _, _, form in columns)
    rules = []
    for _, _, form in columns:
        dashes = "-" * max(3, round(LINE_LENGTH * int(form[1:]) / total))
        rules.append(f":{dashes}" if form[0] == "l" else f"{dashes}:")
    lines = []
    for row in ([title for title, _, _ in columns], rules, *rows):
        # A cell of several lines becomes one line.
        cells = [" ".join(str(cell).split()) for cell in row]
        lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def plain(text: str) -> str:
    """Return a text in which every special character of Markdown is escaped."""
    return re.sub(r"([\\`*_{}\[\]<>#|$~^])", r"\\\1", text)


def code(names: Iterable[str]) -> str:
    """Return names formatted as code and separated by commas."""
    return ", ".join(f"`{name}`" for name in names)


def verdicts(lines: Iterable[Line]) -> str:
    """Return the lines of the answer as a table, in which each verdict links to its claim."""
    link = "[{0.verdict}](../claims.html#{0.id})".format
    rows = []
    for line in lines:
        links = [f"{link(claim)} {subjects}".strip() for claim, subjects in line.verdicts]
        rows.append((line.topic, "; ".join(links), line.text))
    return table("what the paper says l28 | verdict l16 | what was found l56", rows)


def failures(ledger: Ledger) -> str:
    """Return a table of all claims that are not simply reproduced, worst first, with the reason."""
    order = sorted(ledger, key=lambda claim: WORST_FIRST.index(claim.verdict))
    failed = [claim for claim in order if claim.verdict != WORST_FIRST[-1]]
    rows = [(f"{claim.statement} `{claim.id}`", claim.verdict, claim.why) for claim in failed]
    return table("claim l34 | verdict l13 | why l53", rows)


def whole_ledger(ledger: Ledger) -> str:
    """Return a table of all claims: place in the paper, numbers, tolerance, verdict and note."""
    rows = []
    for claim in ledger:
        name = f"{claim.statement} ({claim.figure_or_section}) `{claim.id}`"
        numbers = claim.predicted_text(), claim.measured_text()
        evidence = claim.compared_text(), claim.verdict, claim.evidence_text()
        rows.append((name, *numbers, *evidence))
    head = "claim (section) `id` l32 | predicted r8 | measured r12 | deviation, tolerance l14"
    return table(f"{head} | verdict l9 | evidence l29", rows)


def tolerances(ledger: Ledger) -> str:
    """Return a table of tolerances with their reasons.

    Claims of the same kind with the same tolerance and reason share a row.
    """
    groups: dict[tuple[str, ...], list[str]] = {}
    for claim in ledger:
        exponent = getattr(claim, "tolerance_exponent", None)
        tolerance = setting(claim.tolerance)
        if exponent:
            tolerance += f"; exponent {setting(exponent)}"
        groups.setdefault((claim.kind, tolerance, plain(claim.reason)), []).append(claim.id)
    rows = [(*key, code(ids)) for key, ids in groups.items()]
    return table("kind l11 | tolerance r11 | reason l42 | claims l36", rows)


def checks(entries: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> str:
    """Return a table of statements that tests check, with their places in the paper and tests."""
    where = places_of(entries, sentences)
    rows = [
        (entry["statement"], where[id], entry.get("checked", f"`test_algebra[{id}]`"), code([id]))
        for id, entry in entries.items()
    ]
    return table("what the paper says l44 | section l16 | checked l22 | id l18", rows)


def published(ledger: Ledger, readings: Mapping[str, Mapping]) -> str:
    """Return a table of numbers read off the published figure, with reading errors, beside ours."""
    left = ledger("published_space_time_figure").further
    ours = left | ledger("published_space_time_figure_right").further
    rows = []
    for read in readings.values():
        drawn = with_uncertainty(read["value"], read["reading_error"])
        rows.append((read["statement"], drawn, number(ours.get(read["statement"]), 5)))
    return table("quantity l50 | published r20 | this run r20", rows)


def found_list(ledger: Ledger) -> str:
    """Return all findings as a Markdown list."""
    texts = [" ".join(finding["text"].split()) for finding in ledger.findings.values()]
    return "\n".join(f"- {text}" for text in texts)


def sentence_counts(sentences: Sequence[Mapping]) -> str:
    """Return a table of how many sentences are tested, and how many are not for which reason."""
    words = REASONS | {"all": "all"}
    rows = [(words[reason], count) for reason, count in coverage(sentences).items()]
    return table("sentences l60 | how many r15", rows)


def tested_sentences(sentences: Sequence[Mapping], entries: Mapping[str, Mapping]) -> str:
    """Return a table of the tested sentences, with place in the paper, claims and checks."""
    paragraph = re.compile(r", paragraph (\d+), sentence (\d+)")
    rows = []
    for sentence in sentences:
        claims = claims_of(entries, sentence)
        if claims:
            # The column is narrow, so that paragraph and sentence are shortened to numbers.
            position = paragraph.sub(r", ¶ \1, \2", sentence["place"])
            rows.append((position, sentence["paraphrase"], code(claims)))
    return table("section l22 | what it says l45 | claims l33", rows)


def errata(entries: Sequence[Mapping[str, str]], fill: Callable[[str], str]) -> str:
    """Return a table of the errata, with expressions evaluated by ``fill``."""
    rows = []
    for entry in entries:
        rows.append([fill(entry[key]) for key in ERRATUM])
    head = "where l13 | printed l25 | right l31 | what shows it l22 | alters l9"
    return table(head, rows)


def grid_studies(tables: Mapping[str, pd.DataFrame]) -> str:
    """Return a table of observed order and relative uncertainty from the grid studies."""
    rows = []
    for simulation, quantity, name in STUDIED_QUANTITIES:
        study = tables[f"uncertainties/{simulation}"]
        study = study[study["quantity"] == quantity]
        relative = (study["uncertainty"] / study["value"].abs()).dropna()
        if relative.empty:
            rows.append((name, len(study), DASH, DASH, DASH))
            continue
        orders = study["observed_order"]
        order = number(orders.median(), 2) if orders.notna().any() else DASH
        errors = percent(relative.median()), percent(relative.max())
        rows.append((name, len(relative), order, *errors))
    return table("quantity l40 | runs r10 | order r12 | median uncertainty r20 | largest r18", rows)


def sticking(examples: pd.DataFrame) -> str:
    """Return a table of release time, stick time and slip of an exact rupture at some positions.

    Empty if the study has no exact rupture.
    """
    columns = ["release_time", "stick_time", "final_slip"]
    examples = examples[examples["quantity"].isin(columns)]
    if examples["value"].isna().all():
        return ""
    numbers = examples.pivot(index="x", columns="quantity", values="value")[columns]
    texts = numbers.map(lambda value: number(value, 5))
    rows = [(setting(x), *row) for x, *row in texts.itertuples()]
    head = r"$x$ r10 | release $T$ r15 | stick $t_\mathrm{s}$ r15 | slip $u(x,t_\mathrm{s})$ r15"
    return table(head, rows)


def edges(study: pd.DataFrame) -> str:
    """Return a table of extreme cases: the compared quantity, its error, tolerance and outcome."""
    rows = []
    for row in study.to_dict("records"):
        outcome = str(row["verdict"])
        if outcome == "flagged":
            # The name of the flag is the first word of the message.
            outcome += ": " + str(row["message"]).partition(",")[0].replace("_", " ")
        error = "" if pd.isna(row["error"]) else number(row["error"], 2)
        tolerance = "" if pd.isna(row["tolerance"]) else number(row["tolerance"], 2)
        edge = row["family"], plain(row["value"]), plain(row["quantity"])
        rows.append((*edge, error, tolerance, outcome))
    head = "edge l16 | value l28 | compared l18 | error r12 | tolerance r12 | outcome l24"
    return table(head, rows)


def stability_limits(study: pd.DataFrame) -> str:
    """Derived largest steps by scheme, order and damping ratio, with measured ones in brackets."""
    ratios = sorted(study["damping_ratio"].unique())
    rows = []
    for (scheme, order), group in study.groupby(["scheme", "order"], sort=False):
        cells = [f"{str(scheme).replace('_', ' ')}, order {order}"]
        for row in group.sort_values("damping_ratio").to_dict("records"):
            chain, rupture = (_limit(row, name) for name in ("measured", "measured_rupture"))
            cells.append(f"{number(row['derived'], 3)} ({chain}, {rupture})")
        rows.append(cells)
    head = " | ".join(f"$b$ = {setting(ratio)} l16" for ratio in ratios)
    return table(f"scheme l16 | {head}", rows)


def _limit(row: Mapping, name: str) -> str:
    """A measured limit divided by the derived one, marked where it lies beyond the bisection."""
    sign = {"within": "", "below": "<", "above": ">"}[row[f"{name}_limit"]]
    return f"{sign}{number(row[f'{name}_ratio'], 3)}"


def alteration_note(altered: Iterable[Mapping], ledger: Ledger, verdicts: Mapping[str, str]) -> str:
    """Return a quotation that lists differences from the shipped configuration and verdicts.

    Empty if there are none.
    """
    pair = "`{}`: {} (shipped: {})".format
    keys, judged = [], []
    for change in altered:
        keys.append(pair(change["key"], _literal(change["here"]), _literal(change["shipped"])))
    for change in ledger.differences(verdicts):
        here, shipped = change["here"] or "absent", change["shipped"] or "absent"
        judged.append(pair(change["key"], here, shipped))
    lines = []
    if keys:
        differs = f"This run differs from the shipped configuration in {'; '.join(keys)}."
        lines.append(f"> **Altered configuration.** {differs}")
    if judged:
        lines.append(f"> **Verdicts that differ from the shipped report:** {'; '.join(judged)}.")
    elif keys:
        lines.append("> No verdict differs from the shipped report.")
    return "\n>\n".join(lines)


def _literal(value: object) -> str:
    """Return a value of the configuration formatted as code, or "absent" for None."""
    return "absent" if value is None else "`" + short(value).replace("`", "'") + "`"
