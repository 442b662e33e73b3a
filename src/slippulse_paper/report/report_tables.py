"""Write the tables of the report as Markdown: claims, sentences of the paper, errata, accuracy.

Most functions return one table. The manuscript calls them.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import NamedTuple

import pandas as pd

from ..claims.claim_texts import REASONS, claims_of, coverage, places_of
from ..claims.ledger import Ledger
from ..claims.rules import WITHOUT_RESERVATION, WORST_FIRST
from ..text.numerals import number, percent, setting, short, with_uncertainty
from .texts import ERRATUM, Line

# The line of dashes below the head of a table has about this length. Pandoc takes the numbers of
# dashes in long lines as relative widths of the columns.
LINE_LENGTH = 200
DASH = "\N{EM DASH}"
# Rows of the table of grid studies: simulation, measured column, and name in the table.
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
    "far": "displacement held, longer distance",
    "damped": "displacement held, with damping, longer distance",
    "coupled": "displacement held, strength follows pressure",
    "free": "top free to rise",
    "held": "top held, for comparison",
    "step": "displacement held, step of pre-stress",
    "crack": "stress held",
    "barrier": "stress held, barrier on the left",
}
# Blocks of HTML and Typst around a long table. Between WIDE and CLOSE, it is on landscape pages.
# Between SMALL and CLOSE, it is in small type and may extend over several pages.
OPEN = '`````{{=html}}\n<div class="wide">\n`````\n\n`````{{=typst}}\n#{}[\n`````'.format
WIDE, SMALL = map(OPEN, ("sideways", "small"))
CLOSE = "`````{=typst}\n]\n`````\n\n`````{=html}\n</div>\n`````"
# All figures before FLUSH are placed before the text after it.
FLUSH = "`````{=typst}\n#place.flush()\n`````"
# Figures after BELOW are at the bottom of a page, so that none of them interrupts a table.
BELOW = "`````{=typst}\n#show figure.where(kind: image): set figure(placement: bottom)\n`````"


class Column(NamedTuple):
    """The head of a column: its title, its relative width, and its alignment."""

    title: str
    width: int
    is_left_aligned: bool


def text_column(title: str, width: int) -> Column:
    """Return the head of a column of texts, which are aligned on the left."""
    return Column(title, width, is_left_aligned=True)


def number_column(title: str, width: int) -> Column:
    """Return the head of a column of numbers, which are aligned on the right."""
    return Column(title, width, is_left_aligned=False)


def table(columns: Sequence[Column], rows: Iterable[Sequence[object]]) -> str:
    """Return a pipe table in Markdown."""
    total_width = sum(column.width for column in columns)
    titles = [column.title for column in columns]
    # Below the titles, dashes give the widths, and a colon on one side gives the alignment.
    dashes_and_colons = []
    for column in columns:
        dashes = "-" * max(3, round(LINE_LENGTH * column.width / total_width))
        dashes_and_colons.append(f":{dashes}" if column.is_left_aligned else f"{dashes}:")
    lines = []
    for row in (titles, dashes_and_colons, *rows):
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
    """Return the table that sums up the replication, with one row for each topic of the paper.

    A row has the topic, its verdicts with links to their claims, and what was found.

    lines : lines of the summary, from `texts.judged_lines`
    """
    rows = []
    for line in lines:
        links = []
        # A verdict links to the first claim that has it. The subjects of all such claims follow.
        for claim, subjects in line.verdicts:
            link = f"[{claim.verdict}](../claims.html#{claim.id})"
            links.append(f"{link} {subjects}".strip())
        rows.append((line.topic, "; ".join(links), line.text))
    columns = [
        text_column("what the paper says", 22),
        text_column("verdict", 26),
        text_column("what was found", 52),
    ]
    return table(columns, rows)


def failures(ledger: Ledger) -> str:
    """Return a table of the claims whose verdict needs a reason, with this reason.

    The worst verdicts come first. Claims that are reproduced without reservation are left out.
    """
    worst_first = sorted(ledger, key=lambda claim: WORST_FIRST.index(claim.verdict))
    failed = [claim for claim in worst_first if claim.verdict not in WITHOUT_RESERVATION]
    rows = [(f"{claim.statement} `{claim.id}`", claim.verdict, claim.why) for claim in failed]
    columns = [text_column("claim", 34), text_column("verdict", 13), text_column("why", 53)]
    return table(columns, rows)


def whole_ledger(ledger: Ledger) -> str:
    """Return a table of all claims: place in the paper, numbers, tolerance, verdict, evidence."""
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
    columns = [
        text_column("claim (section) `id`", 32),
        number_column("predicted", 8),
        number_column("measured", 12),
        text_column("deviation, tolerance", 14),
        text_column("verdict", 9),
        text_column("evidence", 29),
    ]
    return table(columns, rows)


def tolerances(ledger: Ledger) -> str:
    """Return a table of the tolerances of claims, with the reason for each tolerance.

    Claims share a row if they have the same kind, the same tolerance and the same reason.
    """
    ids_by_cells: dict[tuple[str, str, str], list[str]] = {}
    for claim in ledger:
        tolerance = setting(claim.tolerance)
        # Claims about a power law also have a tolerance for its exponent.
        exponent = getattr(claim, "tolerance_exponent", None)
        if exponent:
            tolerance += f"; exponent {setting(exponent)}"
        cells = (claim.kind, tolerance, plain(claim.reason))
        ids_by_cells.setdefault(cells, []).append(claim.id)
    rows = [(*cells, code(ids)) for cells, ids in ids_by_cells.items()]
    columns = [
        text_column("kind", 11),
        number_column("tolerance", 11),
        text_column("reason", 42),
        text_column("claims", 36),
    ]
    return table(columns, rows)


def checks(entries: Mapping[str, Mapping], sentences: Sequence[Mapping]) -> str:
    """Return a table of the claims that are checked by tests of the project, with place and test.

    entries : these claims, by their id
    sentences : the sentences of the paper, with their places
    """
    places = places_of(entries, sentences)
    rows = []
    for id, entry in entries.items():
        # Most of these claims are cases of one test.
        test = entry.get("checked", f"`test_algebra[{id}]`")
        rows.append((entry["statement"], places[id], test, code([id])))
    columns = [
        text_column("what the paper says", 44),
        text_column("section", 16),
        text_column("checked", 22),
        text_column("id", 18),
    ]
    return table(columns, rows)


def published(ledger: Ledger, readings: Mapping[str, Mapping]) -> str:
    """Return a table that compares numbers read off the published space-time figure with ours.

    readings : the part ``published`` of the configuration
    """
    # The further numbers of these two claims are our values, by the statement of each reading.
    left_panel = ledger("published_space_time_figure").further
    right_panel = ledger("published_space_time_figure_right").further
    our_values = left_panel | right_panel
    rows = []
    for reading in readings.values():
        statement = reading["statement"]
        published_value = with_uncertainty(reading["value"], reading["reading_error"])
        rows.append((statement, published_value, number(our_values.get(statement), 5)))
    columns = [
        text_column("quantity", 50),
        number_column("published", 20),
        number_column("this run", 20),
    ]
    return table(columns, rows)


def found_list(ledger: Ledger) -> str:
    """Return all findings as a Markdown list."""
    texts = [" ".join(finding["text"].split()) for finding in ledger.findings.values()]
    return "\n".join(f"- {text}" for text in texts)


def sentence_counts(sentences: Sequence[Mapping]) -> str:
    """Return a table of how many sentences are tested, and for each reason how many are not.

    The last row has the number of all sentences.
    """
    # One of the reasons is "tested". `coverage` adds the key "all" for the total.
    titles = REASONS | {"all": "all"}
    rows = [(titles[reason], count) for reason, count in coverage(sentences).items()]
    columns = [text_column("sentences", 60), number_column("how many", 15)]
    return table(columns, rows)


def tested_sentences(sentences: Sequence[Mapping], entries: Mapping[str, Mapping]) -> str:
    """Return a table of the tested sentences, with their place in the paper and their claims.

    entries : all claims, by their id
    """
    rows = []
    for sentence in sentences:
        claims = claims_of(entries, sentence)
        if claims:
            # The column is narrow, so "paragraph 2, sentence 3" is shortened to "¶ 2, 3".
            place = re.sub(r", paragraph (\d+), sentence (\d+)", r", ¶ \1, \2", sentence["place"])
            rows.append((place, sentence["paraphrase"], code(claims)))
    columns = [
        text_column("section", 22),
        text_column("what it says", 45),
        text_column("claims", 33),
    ]
    return table(columns, rows)


def errata(entries: Sequence[Mapping[str, str]], fill: Callable[[str], str]) -> str:
    """Return a table of the errata.

    entries : the errata from `texts.read_errata`
    fill : function that evaluates the expressions in a text
    """
    rows = []
    for entry in entries:
        rows.append([fill(entry[key]) for key in ERRATUM])
    columns = [
        text_column("where", 13),
        text_column("printed", 25),
        text_column("right", 31),
        text_column("what shows it", 22),
        text_column("alters", 9),
    ]
    return table(columns, rows)


def grid_studies(tables: Mapping[str, pd.DataFrame]) -> str:
    """Return a table of the observed order and the relative uncertainty of STUDIED_QUANTITIES.

    The column "runs" counts the runs with a known uncertainty.

    tables : tables by name; those of grid studies have names such as "uncertainties/NAME"
    """
    rows = []
    for simulation, quantity, name in STUDIED_QUANTITIES:
        study = tables[f"uncertainties/{simulation}"]
        study = study[study["quantity"] == quantity]
        relative = (study["uncertainty"] / study["value"].abs()).dropna()
        if relative.empty:
            rows.append((name, 0, DASH, DASH, DASH))
            continue
        orders = study["observed_order"]
        order = number(orders.median(), 2) if orders.notna().any() else DASH
        median, largest = percent(relative.median()), percent(relative.max())
        rows.append((name, len(relative), order, median, largest))
    columns = [
        text_column("quantity", 40),
        number_column("runs", 10),
        number_column("order", 12),
        number_column("median uncertainty", 20),
        number_column("largest", 18),
    ]
    return table(columns, rows)


def sticking(examples: pd.DataFrame) -> str:
    """Return a table of release time, stick time and slip of an exact rupture at some positions.

    Returns an empty text if the study has no exact rupture.

    examples : table of the study, with one row for each position x and quantity
    """
    quantities = ["release_time", "stick_time", "final_slip"]
    examples = examples[examples["quantity"].isin(quantities)]
    if examples["value"].isna().all():
        return ""
    # One row for each position, and one column for each quantity.
    by_position = examples.pivot(index="x", columns="quantity", values="value")[quantities]
    rows = []
    for x, values in by_position.iterrows():
        rows.append([setting(x), *(number(value, 5) for value in values)])
    columns = [
        number_column("$x$", 10),
        number_column("release $T$", 15),
        number_column(r"stick $t_\mathrm{s}$", 15),
        number_column(r"slip $u(x,t_\mathrm{s})$", 15),
    ]
    return table(columns, rows)


def layer_runs(study: pd.DataFrame) -> str:
    """Return a table of the runs of the two-dimensional layer, by part and level of pre-stress.

    The strength falls by Delta tau over the slip d_c. The zone behind the tip in which it falls has
    a length of the order of G d_c/Delta tau, which is gamma d_c in units of the height H. The table
    has this length in cells of the finest grid of each run.

    study : the table of the study layer
    """
    rows = []
    for part, title in LAYER_PARTS.items():
        on_all_grids = study[study["part"] == part].sort_values("cells", kind="stable")
        # The column "cells" has the cells over the height H. The columns below identify a run:
        # "weakening" is d_c, "coupling" the friction coefficient if the strength follows the
        # pressure, and "before" the pre-stress before a step. The finest grid of a run comes last.
        finest = on_all_grids.drop_duplicates(
            ["gamma", "tau0", "weakening", "coupling", "before"], keep="last"
        )
        for tau0, runs in finest.groupby("tau0"):
            lengths_in_cells = runs["gamma"] * runs["weakening"] * runs["cells"]
            shortest = number(lengths_in_cells.min(), 2)
            longest = number(lengths_in_cells.max(), 2)
            row = (
                title,
                setting(tau0),
                _listed_numbers(runs["gamma"]),
                _listed_numbers(runs["fracture_energy"].dropna()) or DASH,
                shortest if shortest == longest else f"{shortest} to {longest}",
                _listed_numbers(on_all_grids["cells"][on_all_grids["tau0"] == tau0]),
                len(runs),
            )
            rows.append(row)
    columns = [
        text_column("top", 28),
        number_column(r"$\tau_0$", 8),
        text_column(r"$\gamma$", 22),
        text_column(r"$G_\mathrm{c}/G_0$", 28),
        number_column(r"$\gamma d_\mathrm{c}/\Delta x$", 16),
        number_column(r"$H/\Delta x$", 10),
        number_column("runs", 6),
    ]
    return table(columns, rows)


def _listed_numbers(values: pd.Series) -> str:
    """Return the distinct values as a text, in ascending order and with three digits."""
    return ", ".join(setting(float(f"{value:.3g}")) for value in sorted(values.unique()))


def edges(study: pd.DataFrame) -> str:
    """Return a table of extreme cases: the compared quantity, its error, tolerance and outcome.

    study : the table of the study extremes
    """
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
    columns = [
        text_column("extreme case", 16),
        text_column("parameters", 28),
        text_column("compared", 18),
        number_column("error", 12),
        number_column("tolerance", 12),
        text_column("outcome", 24),
    ]
    return table(columns, rows)


def stability_limits(study: pd.DataFrame) -> str:
    """Return a table of the largest stable time steps of each scheme and order.

    There is one column for each damping ratio. A cell has the step by theory (derived) and, in
    brackets, two measured steps, divided by it: for a chain of sliding blocks, and for a rupture.

    study : the table of the study stability
    """
    ratios = sorted(study["damping_ratio"].unique())
    rows = []
    for (scheme, order), group in study.groupby(["scheme", "order"], sort=False):
        cells = [f"{str(scheme).replace('_', ' ')}, order {order}"]
        for row in group.sort_values("damping_ratio").to_dict("records"):
            in_chain = _relative_measured_step(row, "measured")
            in_rupture = _relative_measured_step(row, "measured_rupture")
            cells.append(f"{number(row['derived'], 3)} ({in_chain}, {in_rupture})")
        rows.append(cells)
    columns = [text_column("scheme", 16)]
    columns += [text_column(f"$b$ = {setting(ratio)}", 16) for ratio in ratios]
    return table(columns, rows)


def _relative_measured_step(row: Mapping, name: str) -> str:
    """Return a measured largest step divided by the derived one, as text.

    The step was found by bisection. If it lies outside the interval of the bisection, the text
    begins with < or >.

    name : beginning of the names of the two columns NAME_ratio and NAME_limit
    """
    sign = {"within": "", "below": "<", "above": ">"}[row[f"{name}_limit"]]
    return f"{sign}{number(row[f'{name}_ratio'], 3)}"


def alteration_note(altered: Iterable[Mapping], ledger: Ledger, verdicts: Mapping[str, str]) -> str:
    """Return a block quotation of the differences from the shipped configuration and verdicts.

    Returns an empty text if there are none.

    altered : values of the configuration that differ from the shipped ones
    verdicts : the shipped verdict of each claim
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
