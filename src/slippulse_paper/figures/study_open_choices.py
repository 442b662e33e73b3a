"""A specification curve: claims judged by numbers, at each choice that the paper leaves open."""

import pandas as pd
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

from ..claims.ledger import BAND

NEEDS = {"lists": ["results/claims.json"]}

NUMERIC = ("exact", "approximate", "scaling")
# A deviation below this fraction of the tolerance is given as a bound.
LEAST = 1e-2
LOOKS: dict[str, Look] = {
    "fraction": {"color": ORANGE, "label": "fraction that is arrest"},
    "damping_ratio": {"color": BLUE, "label": r"damping ratio $b$"},
    "criterion": {"color": PURPLE, "label": "criterion of the transition"},
    "release": {"color": GREEN, "label": "release rule"},
    "": {"color": GREY, "label": "none is open"},
}
MARKERS: dict[str, Look] = {
    "exact": {"marker": "o"},
    "lattice": {"marker": "s"} | OPEN_MARKER,
}
# Distance above its row at which a deviation is drawn, by release rule.
APART = {"elastic": -0.17, "total": 0.17}


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """One row a claim and combination of choices; a claim without choices has one row."""
    rows, names = [], ["id", "label", "verdict", "tolerance", "choice"]
    for claim in tables["claims"].to_dict("records"):
        if claim["kind"] in NUMERIC and claim["tolerance"]:
            for choices in claim["choices"] or [{"deviation": claim["deviation"]}]:
                judged = {name: claim[name] for name in names}
                rows.append({"release": "", "solution": "lattice"} | choices | judged)
    columns = [*names, "deviation", "release", "solution"]
    drawn = pd.DataFrame(rows)[columns].dropna(subset="deviation")
    return drawn.assign(over=drawn["deviation"] / drawn["tolerance"])


def draw(table: pd.DataFrame) -> Figure:
    """Draw deviation over tolerance, a claim a row, the largest deviation above."""
    table = table.fillna({"choice": "", "release": ""})
    farthest = table.groupby(["id", "label"])["over"].max().sort_values()
    figure = Figure(figsize=(COLUMN_WIDTH, 1.1 + 0.17 * len(farthest)), layout="constrained")
    axes = figure.subplots()
    axes.axvspan(1.0 / BAND, BAND, color=GREY, alpha=0.15, linewidth=0)
    axes.axvline(1.0, color=BLACK, linewidth=0.8)
    for position, (id, _) in enumerate(farthest.index):
        for (choice, solution), rows in table[table["id"] == id].groupby(["choice", "solution"]):
            look = {"color": LOOKS.get(str(choice), LOOKS[""])["color"]} | MARKERS[str(solution)]
            height = position + rows["release"].map(APART).fillna(0.0)
            axes.plot(rows["over"].mask(rows["over"] < LEAST), height, linestyle="none", **look)
        if table.loc[table["id"] == id, "over"].min() < LEAST:
            bound = rf"$\leq$ {LEAST:g}"
            axes.text(LEAST, position, bound, va="center", path_effects=TEXT_OUTLINE)
    axes.set(xscale="log", xlabel="deviation over tolerance", xlim=(0.7 * LEAST, None))
    axes.set_yticks(range(len(farthest)), farthest.index.get_level_values("label"), fontsize=7.0)
    axes.set_ylim(-0.7, len(farthest) - 0.3)
    figure.supylabel("claim")
    axes.grid(axis="y", linewidth=0.3, color=GREY, alpha=0.5)
    shown = [name for name in LOOKS if (table["choice"] == name).any()]
    handles = [entry(marker="o", **LOOKS[name]) for name in shown]
    handles += [entry(name, color=BLACK, **look) for name, look in MARKERS.items()]
    style.legend_below(figure, handles, 2)
    return figure
