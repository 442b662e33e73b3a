"""A whole rupture, exact beside lattice: space-time, fronts, trailing edge and slip, and how their difference falls."""

from __future__ import annotations

from collections.abc import Mapping

import matplotlib
import numpy as np
import pandas as pd
import xarray as xr
from matplotlib.figure import Figure

from ..data.numerals import setting
from ..data.points import point
from ..predict.exact_rupture import differences, exact_rupture
from ..theory.rupture import Rupture
from .style import BLACK, BLUE, GREEN, GREY, ORANGE, PAGE, PURPLE, VELOCITY_MAP, new_figure, panel_letter

SCENES = ("exact_displacement", "exact_asymmetric", "exact_stress")

# What is drawn: data, measured numbers and studies by name, and keys of the configuration.
NEEDS = {"data": ["exact_displacement", "exact_asymmetric", "exact_stress"]}

QUANTITIES = {
    "release": ("release", "o", BLUE),
    "stick": ("stick", "s", ORANGE),
    "slip": ("slip", "^", GREEN),
    "velocity": ("slip velocity", "D", PURPLE),
}
CURVE_POINTS, MARKS = 401, 41
# The map and the markers are of the run that is nearest this spacing.
SHOWN = 0.04


def table(
    data: Mapping[str, xr.Dataset], measured: Mapping[str, pd.DataFrame], settings: Mapping
) -> pd.DataFrame:
    """Exact curves, the lattice's markers, two halves of a map, and the difference against the spacing.

    Parameters
    ----------
    data : the simulations in SCENES
    measured, settings : not used

    Returns
    -------
    DataFrame of scene, left, right, gamma, role, quantity, source ("exact" or "lattice"), dx, time, position, value;
    roles: edge (release or stick time, or slip, over position), map (slip velocity), difference (relative, in the
    mean), limit (where the exact construction ends, if it does: time, position)
    """
    parts = []
    for scene in SCENES:
        sweep = data[scene]
        runs = [point(sweep, index) for index in range(sweep.sizes["point"])]
        rupture = exact_rupture(runs[0].attrs)
        shown = min(runs, key=lambda run: abs(np.log(run.attrs["dx"] / SHOWN)))
        common = {name: shown.attrs[name] for name in ("left", "right", "gamma", "damping_ratio")}
        rows = [_exact_edges(rupture), _lattice_edges(shown), _limits(rupture)]
        if scene == SCENES[0]:
            rows.append(_map(shown, rupture))
        rows += [
            differences(run, rupture)
            .rename(columns={"difference": "value"})
            .assign(role="difference", source="lattice", dx=run.attrs["dx"])
            for run in runs
        ]
        parts.append(pd.concat(rows).assign(scene=scene, **common))
    return pd.concat(parts, ignore_index=True)


def _exact_edges(rupture: Rupture) -> pd.DataFrame:
    ends = rupture.front_ends
    x = np.linspace(ends[0][0].x, ends[-1][1].x, CURVE_POINTS)[1:-1]
    values = {
        "release": rupture.release_time(x), "stick": rupture.stick_time(x), "slip": rupture.slip(x, rupture.duration),
    }  # fmt: skip
    return pd.concat(
        pd.DataFrame({"position": x, "value": value}).assign(role="edge", quantity=name, source="exact")
        for name, value in values.items()
    )


def _lattice_edges(run: xr.Dataset) -> pd.DataFrame:
    released = np.flatnonzero(np.isfinite(run["release_time"].values))
    kept = released[:: max(1, released.size // MARKS)]
    names = {"release": "release_time", "stick": "stick_time", "slip": "slip"}
    return pd.concat(
        pd.DataFrame({"position": run["x"].values[kept], "value": run[name].values[kept]}).assign(
            role="edge", quantity=quantity, source="lattice", dx=run.attrs["dx"]
        )
        for quantity, name in names.items()
    )


def _limits(rupture: Rupture) -> pd.DataFrame:
    end = rupture.limit
    rows = [{"role": "limit", "source": "exact", "time": end.time, "position": end.x}] if end else []
    return pd.DataFrame(rows)


def _map(run: xr.Dataset, rupture: Rupture) -> pd.DataFrame:
    """The lattice's samples right of the middle, and the exact solution at the same points left of it."""
    x, times = run["sample_position"].values, run["sample_time"].values
    velocity = {
        "lattice": run["sample_velocity"].values, "exact": rupture.map(times, x, ("slip_velocity",))["slip_velocity"],
    }  # fmt: skip
    parts = []
    for source, half in (("exact", x < 1e-9), ("lattice", x > -1e-9)):
        time, position = np.meshgrid(times, x[half], indexing="ij")
        parts.append(
            pd.DataFrame(
                {"time": time.ravel(), "position": position.ravel(), "value": velocity[source][:, half].ravel()}
            ).assign(role="map", source=source)
        )  # fmt: skip
    return pd.concat(parts).round({"value": 5})


def plot(table: pd.DataFrame) -> Figure:
    """Above: the map, both edges, the slip. Below: the difference over the spacing, one panel a scene."""
    figure = new_figure(PAGE, 5.0)
    grid = figure.subplots(2, 3)
    _draw_map(figure, grid[0, 0], table[table["scene"] == SCENES[0]])
    _draw_edges(grid[0, 1], table, ("release", "stick"))
    _draw_edges(grid[0, 2], table, ("slip",))
    for axes, scene in zip(grid[1], SCENES, strict=True):
        _draw_differences(axes, table[table["scene"] == scene])
    low, high = table.loc[table["role"] == "difference", "value"].agg(["min", "max"])
    for axes in grid[1]:
        axes.set_ylim(0.3 * low, 25.0 * high)
    grid[1, 0].set_ylabel("mean |lattice $-$ exact| / mean exact")
    for axes, letter in zip(grid.ravel(), "abcdef", strict=True):
        panel_letter(axes, letter)
    return figure


def _draw_map(figure: Figure, axes, rows: pd.DataFrame) -> None:
    samples = rows[rows["role"] == "map"]
    for source in ("exact", "lattice"):
        grid = samples[samples["source"] == source].pivot(index="time", columns="position", values="value")
        # What does not slide stays white.
        image = axes.pcolormesh(
            grid.columns, grid.index, grid.where(grid > 0.0).to_numpy(), shading="nearest",
            cmap=matplotlib.colormaps[VELOCITY_MAP], vmin=0.0, vmax=float(samples["value"].max()), rasterized=True,
        )  # fmt: skip
    for quantity, style in (("release", "-"), ("stick", "--")):
        line = _edge(rows, quantity, "exact")
        axes.plot(line["position"], line["value"], style, color=BLACK, linewidth=0.9, gid=f"exact {quantity}")
    axes.axvline(0.0, color=BLACK, linewidth=0.6, linestyle=":")
    for place, name in ((0.04, "exact"), (0.96, "lattice")):
        axes.text(
            place, 0.04, name, transform=axes.transAxes, fontsize=8.0,
            ha="left" if place < 0.5 else "right",
        )  # fmt: skip
    bar = figure.colorbar(image, ax=axes, location="top", aspect=25, pad=0.02)
    bar.set_label(r"slip velocity $\dot u$")
    axes.set(xlabel=r"position $x$", ylabel=r"time $t$")


def _edge(rows: pd.DataFrame, quantity: str, source: str) -> pd.DataFrame:
    chosen = rows[(rows["role"] == "edge") & (rows["quantity"] == quantity) & (rows["source"] == source)]
    return chosen.sort_values("position")


def _draw_edges(axes, table: pd.DataFrame, quantities: tuple[str, ...]) -> None:
    """Exact lines and the lattice's markers of the scenes that stick."""
    for colour, scene in zip((BLUE, ORANGE), SCENES[:2], strict=True):
        rows = table[table["scene"] == scene]
        for quantity in quantities:
            style, marker = ("--", "s") if quantity == "stick" else ("-", "o")
            exact, lattice = _edge(rows, quantity, "exact"), _edge(rows, quantity, "lattice")
            axes.plot(
                exact["position"], exact["value"], style, color=colour, linewidth=0.9, gid=f"exact {quantity} {scene}"
            )  # fmt: skip
            axes.plot(
                lattice["position"], lattice["value"], marker, color=colour, markersize=2.2, markerfacecolor="white",
                markeredgewidth=0.6, gid=f"lattice {quantity} {scene}",
            )  # fmt: skip
    axes.set_xlabel(r"position $x$")
    top = max(float(np.nanmax(line.get_ydata())) for line in axes.lines)
    if quantities == ("slip",):
        axes.set(ylabel=r"slip $u$", ylim=(0.0, 1.28 * top))
        for colour, scene in zip((BLUE, ORANGE), SCENES[:2], strict=True):
            axes.plot([], [], color=colour, label=_name(table[table["scene"] == scene]))
    else:
        axes.set(ylabel=r"time $t$", ylim=(0.0, 1.45 * top))
        dx = table.loc[(table["role"] == "edge") & (table["source"] == "lattice"), "dx"].iloc[0]
        for look, label in (
            ({"linestyle": "-"}, "front, exact"),
            ({"linestyle": "--"}, "trailing edge, exact"),
            ({"linestyle": "none", "marker": "o"}, rf"lattice, $\Delta x = {dx:g}$"),
        ):
            axes.plot([], [], color="0.3", markersize=2.5, markerfacecolor="white", label=label, **look)
    axes.legend(loc="upper left", labelspacing=0.2, handlelength=1.4)
    for _, end in table[(table["role"] == "limit") & table["scene"].isin(SCENES[:2])].iterrows():
        axes.axvline(end["position"], color=BLACK, linewidth=0.6, linestyle=":")
        axes.text(
            end["position"], 0.5, "exact solution ends", transform=axes.get_xaxis_transform(), rotation=90
        )


def _name(rows: pd.DataFrame) -> str:
    first = rows.iloc[0]
    springs = rf"$\Gamma = 1$, $\gamma = {first['gamma']:g}$" if first["gamma"] > 0.0 else r"$\Gamma = 0$"
    levels = [setting(first["left"])] + ([setting(first["right"])] if first["right"] != first["left"] else [])
    return rf"{springs}, $\tau_0$ = {', '.join(levels)}"


def _draw_differences(axes, rows: pd.DataFrame) -> None:
    found = rows[rows["role"] == "difference"]
    for quantity, (label, marker, colour) in QUANTITIES.items():
        line = found[found["quantity"] == quantity].sort_values("dx")
        if line.empty:
            continue
        order = slope(line["dx"], line["value"])
        axes.plot(
            line["dx"], line["value"], marker=marker, color=colour, markersize=3.0,
            label=f"{label}: order {order:.2f}", gid=quantity,
        )  # fmt: skip
    ends = np.array([found["dx"].min(), found["dx"].max()])
    guide = 0.5 * found["value"].min() / ends[0]
    axes.plot(ends, guide * ends, color=GREY, linewidth=0.8, linestyle=":", label="first order", gid="guide")
    axes.set(xscale="log", yscale="log", xlabel=r"spacing $\Delta x$")
    axes.set_title(_name(rows), loc="right", fontsize=8.5)
    axes.legend(loc="upper left", labelspacing=0.25)
    axes.set_xticks([0.005, 0.01, 0.02, 0.04, 0.08], ["0.005", "0.01", "0.02", "0.04", "0.08"])
    axes.xaxis.set_minor_formatter(matplotlib.ticker.NullFormatter())


def slope(spacing, value) -> float:
    """Observed order: the slope of a straight line through all points in logarithmic axes."""
    return float(np.polyfit(np.log(spacing), np.log(value), 1)[0])
