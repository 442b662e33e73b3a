"""Write the tables of the report as Markdown: claims, sentences of the paper, errata, accuracy."""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple, Self

import pandas as pd

from ..claims.claim_texts import REASONS, claims_of, coverage, places_of
from ..claims.ledger import Ledger
from ..claims.rules import WITHOUT_RESERVATION, WORST_FIRST
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
# Parts of the study of the two-dimensional layer, by their name in the table of its runs.
LAYER_PARTS = {
    "pulse": "displacement held",
    "step": "displacement held, step of pre-stress",
    "crack": "stress held",
    "barrier": "stress held, barrier on the left",
}
# Markers around a long table: WIDE and CLOSE put it on landscape pages, SMALL and CLOSE set it in
# small type over several pages. FLUSH places all earlier figures before the text that follows.
OPEN = '`````{{=html}}\n<div class="wide">\n`````\n\n`````{{=typst}}\n#{}[\n`````'.format
WIDE, SMALL = map(OPEN, ("sideways", "small"))
CLOSE = "`````{=typst}\n]\n`````\n\n`````{=html}\n</div>\n`````"
FLUSH = "`````{=typst}\n#place.flush()\n`````"
# Figures after BELOW go to the bottom of a page, so that none interrupts the table before it.
BELOW = "`````{=typst}\n#show figure.where(kind: image): set figure(placement: bottom)\n`````"


class _Column(NamedTuple):
    """Head of a column: its title, its alignment (l or r) and its relative width."""

    title: str
    alignment: str
    width: int

    @classmethod
    def read(cls, text: str) -> Self:
        """Read the head from a text such as "claim l34"."""
        title, _, layout = text.strip().rpartition(" ")
        return cls(title, alignment=layout[0], width=int(layout[1:]))


def table(head: str, rows: Iterable[Sequence[object]]) -> str:
    """Return a pipe table in Markdown.

    head : the heads of all columns as `_Column` reads them, such as "claim l34 | runs r10"
    """
    columns = [_Column.read(text) for text in head.split("|")]
    total_width = sum(column.width for column in columns)
    rules = []
    for column in columns:
        dashes = "-" * max(3, round(LINE_LENGTH * column.width / total_width))
        rules.append(f":{dashes}" if column.alignment == "l" else f"{dashes}:")
    titles = [column.title for column in columns]
    lines = []
    for row in (titles, rules, *rows):
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
    rows = []
    for line in lines:
        links = []
        for claim, subjects in line.verdicts:
            link = f"[{claim.verdict}](../claims.html#{claim.id})"
            links.append(f"{link} {subjects}".strip())
        rows.append((line.topic, "; ".join(links), line.text))
    return table("what the paper says l28 | verdict l16 | what was found l56", rows)


def failures(ledger: Ledger) -> str:
    """Return a table of all claims that are not simply reproduced, worst first, with the reason."""
    order = sorted(ledger, key=lambda claim: WORST_FIRST.index(claim.verdict))
    failed = [claim for claim in order if claim.verdict not in WITHOUT_RESERVATION]
    rows = [(f"{claim.statement} `{claim.id}`", claim.verdict, claim.why) for claim in failed]
    return table("claim l34 | verdict l13 | why l53", rows)


def whole_ledger(ledger: Ledger) -> str:
    """Return a table of all claims: place in the paper, numbers, tolerance, verdict and note."""
    rows = []
    for claim in ledger:
        row = (
            f"{claim.statement} ({claim.figure_or_section}) `{claim.id}`",
            claim.predicted_text(),
            claim.measured_text(),
            claim.compared_text(),
            claim.verdict,
            claim.evidence_text(),
        )
        rows.append(row)
    head = "claim (section) `id` l32 | predicted r8 | measured r12 | deviation, tolerance l14"
    return table(f"{head} | verdict l9 | evidence l29", rows)


def tolerances(ledger: Ledger) -> str:
    """Return a table of tolerances with their reasons.

    Claims of the same kind with the same tolerance and reason share a row.
    """
    ids_by_cells: dict[tuple[str, str, str], list[str]] = {}
    for claim in ledger:
        tolerance = setting(claim.tolerance)
        exponent = getattr(claim, "tolerance_exponent", None)
        if exponent:
            tolerance += f"; exponent {setting(exponent)}"
        cells = (claim.kind, tolerance, plain(claim.reason))
        ids_by_cells.setdefault(cells, []).append(claim.id)
    rows = [(*cells, code(ids)) for cells, ids in ids_by_cells.items()]
    return table("kind l11 | tolerance r11 | reason l42 | claims l36", rows)


def checks(entries: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> str:
    """Return a table of statements that tests check, with their places in the paper and tests."""
    places = places_of(entries, sentences)
    rows = []
    for id, entry in entries.items():
        test = entry.get("checked", f"`test_algebra[{id}]`")
        rows.append((entry["statement"], places[id], test, code([id])))
    return table("what the paper says l44 | section l16 | checked l22 | id l18", rows)


def published(ledger: Ledger, readings: Mapping[str, Mapping]) -> str:
    """Return a table of numbers read off the published figure, with reading errors, beside ours."""
    left_panel = ledger("published_space_time_figure").further
    right_panel = ledger("published_space_time_figure_right").further
    ours = left_panel | right_panel
    rows = []
    for reading in readings.values():
        statement = reading["statement"]
        drawn = with_uncertainty(reading["value"], reading["reading_error"])
        rows.append((statement, drawn, number(ours.get(statement), 5)))
    return table("quantity l50 | published r20 | this run r20", rows)


def found_list(ledger: Ledger) -> str:
    """Return all findings as a Markdown list."""
    texts = [" ".join(finding["text"].split()) for finding in ledger.findings.values()]
    return "\n".join(f"- {text}" for text in texts)


def sentence_counts(sentences: Sequence[Mapping]) -> str:
    """Return a table of how many sentences are tested, and how many are not for which reason."""
    titles = REASONS | {"all": "all"}
    rows = [(titles[reason], count) for reason, count in coverage(sentences).items()]
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
        median, largest = percent(relative.median()), percent(relative.max())
        rows.append((name, len(relative), order, median, largest))
    return table("quantity l40 | runs r10 | order r12 | median uncertainty r20 | largest r18", rows)


def sticking(examples: pd.DataFrame) -> str:
    """Return a table of release time, stick time and slip of an exact rupture at some positions.

    Returns no text if the study has no exact rupture.
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


def layer_runs(study: pd.DataFrame) -> str:
    """Return a table of the runs of the two-dimensional layer, by part and level of pre-stress.

    The strength falls over the slip d_c. The length G d_c/Delta tau, with the drop of strength
    Delta tau, is gamma d_c in units of H. It is given in cells of the finest grid of each run.
    """
    rows = []
    for part, title in LAYER_PARTS.items():
        runs = study[study["part"] == part].sort_values("cells", kind="stable")
        finest = runs.drop_duplicates(["gamma", "tau0", "weakening", "before"], keep="last")
        for tau0, group in finest.groupby("tau0"):
            length = group["gamma"] * group["weakening"] * group["cells"]
            energies = _listed_numbers(group["fracture_energy"].dropna()) or DASH
            low, high = (number(end, 2) for end in (length.min(), length.max()))
            row = (title, setting(tau0), _listed_numbers(group["gamma"]), energies)
            lengths = low if low == high else f"{low} to {high}"
            rows.append((*row, lengths, _listed_numbers(group["cells"]), len(group)))
    head = r"top l28 | $\tau_0$ r8 | $\gamma$ l22 | $G_\mathrm{c}/G_0$ l28"
    head += r" | $\gamma d_\mathrm{c}/\Delta x$ r16 | $H/\Delta x$ r10 | runs r6"
    return table(head, rows)


def _listed_numbers(values: pd.Series) -> str:
    """Return the distinct values in ascending order, to three digits."""
    return ", ".join(setting(float(f"{value:.3g}")) for value in sorted(values.unique()))


def edges(study: pd.DataFrame) -> str:
    """Return a table of extreme cases: the compared quantity, its error, tolerance and outcome."""
    rows = []
    for row in study.to_dict("records"):
        outcome = str(row["verdict"])
        if outcome == "flagged":
            # The message begins with the name of the flag and a comma.
            flag, _, _ = str(row["message"]).partition(",")
            outcome += f": {flag.replace('_', ' ')}"
        error = "" if pd.isna(row["error"]) else number(row["error"], 2)
        tolerance = "" if pd.isna(row["tolerance"]) else number(row["tolerance"], 2)
        value, quantity = plain(row["value"]), plain(row["quantity"])
        rows.append((row["family"], value, quantity, error, tolerance, outcome))
    head = "edge l16 | value l28 | compared l18 | error r12 | tolerance r12 | outcome l24"
    return table(head, rows)


def stability_limits(study: pd.DataFrame) -> str:
    """Return a table of derived largest steps, with the measured ones in brackets.

    The rows are schemes and orders, and the columns damping ratios.
    """
    ratios = sorted(study["damping_ratio"].unique())
    rows = []
    for (scheme, order), group in study.groupby(["scheme", "order"], sort=False):
        cells = [f"{str(scheme).replace('_', ' ')}, order {order}"]
        for row in group.sort_values("damping_ratio").to_dict("records"):
            in_chain = _measured_limit(row, "measured")
            in_rupture = _measured_limit(row, "measured_rupture")
            cells.append(f"{number(row['derived'], 3)} ({in_chain}, {in_rupture})")
        rows.append(cells)
    head = " | ".join(f"$b$ = {setting(ratio)} l16" for ratio in ratios)
    return table(f"scheme l16 | {head}", rows)


def _measured_limit(row: Mapping, name: str) -> str:
    """Return a measured limit divided by the derived one.

    A sign marks a limit that lies outside the interval of the bisection.
    """
    sign = {"within": "", "below": "<", "above": ">"}[row[f"{name}_limit"]]
    return f"{sign}{number(row[f'{name}_ratio'], 3)}"


def alteration_note(altered: Iterable[Mapping], ledger: Ledger, verdicts: Mapping[str, str]) -> str:
    """Return a quotation that lists differences from the shipped configuration and verdicts.

    Returns no text if there are none.
    """
    altered_values = []
    for change in altered:
        here, shipped = _literal(change["here"]), _literal(change["shipped"])
        altered_values.append(f"`{change['key']}`: {here} (shipped: {shipped})")
    altered_verdicts = []
    for change in ledger.differences(verdicts):
        here, shipped = change["here"] or "absent", change["shipped"] or "absent"
        altered_verdicts.append(f"`{change['key']}`: {here} (shipped: {shipped})")
    lines = []
    if altered_values:
        differs = f"This run differs from the shipped configuration in {'; '.join(altered_values)}."
        lines.append(f"> **Altered configuration.** {differs}")
    if altered_verdicts:
        differing = "; ".join(altered_verdicts)
        lines.append(f"> **Verdicts that differ from the shipped report:** {differing}.")
    elif altered_values:
        lines.append("> No verdict differs from the shipped report.")
    return "\n>\n".join(lines)


def _literal(value: object) -> str:
    """Return a value of the configuration formatted as code, or "absent" for None."""
    if value is None:
        return "absent"
    text = short(value).replace("`", "'")
    return f"`{text}`"
