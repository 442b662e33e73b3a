"""A specification curve: how far claims are off, at every choice that the paper leaves open.

Each claim with a numerical tolerance is judged at all combinations of the open choices. The figure
shows the deviation at each combination.
"""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.style import (
    BLACK,
    BLUE,
    COLUMN_WIDTH,
    GREEN,
    GREY,
    OPEN_MARKER,
    ORANGE,
    PURPLE,
    TEXT_OUTLINE,
    Look,
    entry,
)

from ..claims.ledger import TOLERANCE_BAND

NEEDS = {"lists": ["results/claims.json"]}

NUMERIC_KINDS = ("exact", "approximate", "scaling")
# A deviation below this fraction of the tolerance is shown as an upper bound.
MIN_SHOWN_RATIO = 1e-2
# Colours of the choice on which the verdict depends most.
CHOICE_LOOKS: dict[str, Look] = {
    "fraction": {"color": ORANGE, "label": "fraction of the path"},
    "damping_ratio": {"color": BLUE, "label": r"damping ratio $b$"},
    "criterion": {"color": PURPLE, "label": "end of the transition"},
    "release": {"color": GREEN, "label": "release rule"},
    "": {"color": GREY, "label": "no open choice"},
}
# Markers of claims that are judged by exact theory ("exact") or by runs ("lattice").
SOLUTION_MARKERS: dict[str, Look] = {
    "exact": {"marker": "o"},
    "lattice": {"marker": "s"} | OPEN_MARKER,
}
# Vertical distance of a deviation from the middle of its row, by release rule.
ROW_OFFSETS = {"elastic": -0.17, "total": 0.17}


def table(data: dict, tables: dict[str, pd.DataFrame], settings: dict) -> pd.DataFrame:
    """Return one row for each claim and combination of open choices.

    The column over has the deviation divided by the tolerance. The column choice names the choice
    on which the verdict depends most. The columns release and solution have two values of the
    combination: the release rule, and whether the claim is judged by exact theory ("exact") or by
    runs ("lattice"). A claim without open choices has one row.
    """
    claim_columns = ["id", "label", "verdict", "tolerance", "choice"]
    # Values for a combination that does not contain these choices.
    default_choices = {"release": "", "solution": "lattice"}
    rows = []
    for claim in tables["claims"].to_dict("records"):
        if claim["kind"] in NUMERIC_KINDS and claim["tolerance"]:
            claim_values = {name: claim[name] for name in claim_columns}
            # A combination has the value of each choice by its name, and the deviation.
            combinations = claim["choices"] or [{"deviation": claim["deviation"]}]
            for combination in combinations:
                rows.append(default_choices | combination | claim_values)
    columns = [*claim_columns, "deviation", "release", "solution"]
    drawn = pd.DataFrame(rows)[columns].dropna(subset="deviation")
    return drawn.assign(over=drawn["deviation"] / drawn["tolerance"])


def draw(table: pd.DataFrame) -> Figure:
    """Draw deviations divided by tolerances, with one row of markers for each claim.

    The claim with the largest value is on top. The legend explains the colours, which stand for
    open choices, and the markers, which stand for exact theory or lattice runs.
    """
    # A CSV file has NaN in place of an empty text.
    table = table.fillna({"choice": "", "release": ""})
    largest = table.groupby(["id", "label"])["over"].max().sort_values()
    figure = Figure(figsize=(COLUMN_WIDTH, 1.1 + 0.17 * len(largest)), layout="constrained")
    axes = figure.subplots()
    # Verdicts change at 1. A band around 1 shows ratios that are close to the tolerance.
    axes.axvspan(1.0 / TOLERANCE_BAND, TOLERANCE_BAND, color=GREY, alpha=0.15, linewidth=0)
    axes.axvline(1.0, color=BLACK, linewidth=0.8)
    for position, (id, _) in enumerate(largest.index):
        draw_claim(axes, table[table["id"] == id], position)
    axes.set(xscale="log", xlabel="deviation / tolerance", xlim=(0.7 * MIN_SHOWN_RATIO, None))
    axes.set_yticks(range(len(largest)), largest.index.get_level_values("label"), fontsize=7.0)
    axes.set_ylim(-0.7, len(largest) - 0.3)
    figure.supylabel("claim")
    axes.grid(axis="y", linewidth=0.3, color=GREY, alpha=0.5)
    shown = [name for name in CHOICE_LOOKS if (table["choice"] == name).any()]
    handles = [entry(marker="o", **CHOICE_LOOKS[name]) for name in shown]
    handles += [entry(name, color=BLACK, **look) for name, look in SOLUTION_MARKERS.items()]
    style.legend_below(figure, handles, columns=2)
    return figure


def draw_claim(axes: Axes, claim: pd.DataFrame, position: int) -> None:
    """Mark the deviations of one claim, divided by its tolerance (column over), in a row.

    The colour is that of the choice on which the verdict depends most. Each release rule has its
    own height in the row, and each solution (exact theory or lattice) its own marker.

    position : vertical position of the row
    """
    for (choice, solution), rows in claim.groupby(["choice", "solution"]):
        # A choice without a look of its own is grey, as is a verdict that depends on no choice.
        choice_look = CHOICE_LOOKS.get(str(choice), CHOICE_LOOKS[""])
        look: Look = {"color": choice_look["color"], "linestyle": "none"}
        look |= SOLUTION_MARKERS[str(solution)]
        is_shown = rows["over"] >= MIN_SHOWN_RATIO
        height = position + rows["release"].map(ROW_OFFSETS).fillna(0.0)
        axes.plot(rows["over"].where(is_shown), height, **look)
    # Smaller ratios, down to 0, do not fit on the logarithmic axis. One text stands for all.
    if claim["over"].min() < MIN_SHOWN_RATIO:
        bound = rf"$\leq$ {MIN_SHOWN_RATIO:g}"
        axes.text(MIN_SHOWN_RATIO, position, bound, va="center", path_effects=TEXT_OUTLINE)
