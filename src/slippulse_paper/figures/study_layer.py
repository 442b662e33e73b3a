"""Pulses of the layer in the plane, and one dimension over the plane against their width."""

import pandas as pd
from matplotlib.figure import Figure

from slippulse.plotting import style
from slippulse.plotting.style import BLACK, GREY, OPEN, PAGE, Look, entry

NEEDS = {"studies": ["layer"]}

QUANTITIES = {"speed": "front speed", "pulse_width": "width", "pulse_slip": "slip"}
QUANTITIES["first_stick"] = "first stick"
# Numbers of one dimension by the prefix of their columns: how they are drawn, and what they are.
LOOKS: dict[str, Look] = {
    "paper": {"linestyle": "-", "marker": "o", "label": "formula of the paper"},
    "damped": {"linestyle": ":", "marker": "s"} | OPEN,
    "balance": {"linestyle": "--", "marker": "^", "label": "balance of energy"} | OPEN,
    "strip": {"linestyle": "--", "marker": "v", "label": "shear wave to the top and back"} | OPEN,
}
LOOKS["damped"]["label"] = "1D, the same slip weakening, the paper's damping"
# Colours end at this fraction of the largest velocity, which is that of the tip alone.
BRIGHT = 0.6
KEYS = ["source", "tau0"]


def table(data: dict, tables: dict, settings: dict) -> pd.DataFrame:
    """One dimension over the plane on the finest grid (part ratio), and a field (part field)."""
    study = tables["layer"]
    runs = study[study["part"] == "pulse"]
    runs = runs[(runs["cells"] == runs["cells"].max()) & (runs["station"] == runs["station"].max())]
    parts = [study[study["part"] == "field"].dropna(axis="columns", how="all")]
    for source in LOOKS:
        for quantity in QUANTITIES:
            if f"{source}_{quantity}" in runs:
                ratio = runs[f"{source}_{quantity}"] / runs[quantity]
                known = {"part": "ratio", "source": source, "quantity": quantity, "ratio": ratio}
                parts.append(runs[["gamma", "tau0", "pulse_width"]].assign(**known))
    return pd.concat(parts, ignore_index=True)


def draw(table: pd.DataFrame) -> Figure:
    """Draw (a) the velocity over the layer, (b-e) ratios of one dimension to the plane."""
    figure, (map_axes, *panels) = style.new_panels(PAGE, 3.9, "aaaa;bcde", height_ratios=(1.0, 2.9))
    field = table[table["part"] == "field"]
    grid = field.pivot(index="y", columns="x", values="velocity")
    brightest = BRIGHT * float(grid.to_numpy().max())
    look: Look = {"cmap": "RdBu_r", "vmin": -brightest, "vmax": brightest, "shading": "gouraud"}
    image = map_axes.pcolormesh(grid.columns, grid.index, grid, rasterized=True, **look)
    bar = figure.colorbar(image, ax=map_axes, aspect=6, pad=0.01, extend="max")
    bar.set_label(r"$\dot u_x$")
    map_axes.set(aspect="equal", xlabel=r"position $x/H$", ylabel=r"$y/H$", yticks=(0.0, 1.0))
    time, tau0, gamma = field[["time", "tau0", "gamma"]].iloc[0]
    map_axes.set_title(style.conditions(True, tau_0=tau0, gamma=round(gamma, 3), time=time))
    ratios = table[table["part"] == "ratio"]
    ends = 0.8 * ratios["ratio"].min(), 1.25 * ratios["ratio"].max()
    for axes, (quantity, name) in zip(panels, QUANTITIES.items(), strict=True):
        for (source, tau0), line in ratios[ratios["quantity"] == quantity].groupby(KEYS):
            line, colour = line.sort_values("pulse_width"), style.colour("tau_0", tau0)
            axes.plot(line["pulse_width"], line["ratio"], color=colour, **LOOKS[source])
        axes.axhline(1.0, color=BLACK, linewidth=0.6)
        axes.set(xscale="log", xlabel=r"width $W_\mathrm{p}/H$", title=name)
        axes.set(yscale="log", ylim=ends)
        style.few_ticks(axes.xaxis, (2.0, 4.0, 8.0))
        style.few_ticks(axes.yaxis, (0.2, 0.5, 1.0, 2.0, 5.0))
    panels[0].set_ylabel("one dimension / plane")
    handles = [entry(color=GREY, **look) for look in LOOKS.values()]
    for tau0 in ratios["tau0"].unique():
        handles.append(entry(rf"$\tau_0 = {tau0:g}$", color=style.colour("tau_0", tau0)))
    style.legend_below(figure, handles, 4)
    return figure
