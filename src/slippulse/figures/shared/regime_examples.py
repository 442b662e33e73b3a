"""Examples of regimes below a phase diagram: pre-stress, and slip velocity towards the end of a run."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pandas as pd
import xarray as xr

from ...data.numerals import setting
from ..style import BLACK, GREY

# Points kept of each profile.
PROFILE_POINTS = 500
# Examples beside each other.
ACROSS = 3
EARLIER_DASHES = (0, (3, 1.2))


def profiles(run: xr.Dataset) -> pd.DataFrame:
    """Pre-stress, and slip velocity at two thirds of the duration and at the end, where anything slipped."""
    x, released = run["x"].values, np.isfinite(run["release_time"].values)
    margin = 0.08 * (x[released][-1] - x[released][0])
    lower, upper = x[released][0] - margin, x[released][-1] + margin
    at, times = run["sample_position"].values, run["sample_time"].values
    before = int(np.argmin(np.abs(times - 2.0 / 3.0 * times[-1])))
    # The levels go on beyond the lattice, which ends where the fronts do.
    tau = run["prestress"].values
    wide, tau = np.concatenate([[lower], x, [upper]]), np.concatenate([tau[:1], tau, tau[-1:]])
    curves = [("prestress", np.nan, wide, tau)]
    for series, index in (("velocity_before", before), ("velocity_end", -1)):
        curves.append((series, times[index], at, run["sample_velocity"].values[index]))
    frames = []
    for series, time, position, value in curves:
        inside = np.flatnonzero((position >= lower) & (position <= upper))
        kept = inside[:: max(1, int(np.ceil(inside.size / PROFILE_POINTS)))]
        # Regular thinning may step over a peak.
        kept = np.union1d(kept, [inside[np.argmax(value[inside])], inside[-1]])
        order = kept[np.argsort(position[kept], kind="stable")]
        frames.append(pd.DataFrame({"series": series, "time": time, "x": position[order], "y": value[order]}))
    return pd.concat(frames)


def draw_examples(figure, table: pd.DataFrame, colours: Mapping[str, str]) -> None:
    """Pre-stress above slip velocity of each example, in the colour of its regime."""
    examples = table[table["role"] == "example"]
    bands = -(-len(examples) // ACROSS)
    grid = figure.add_gridspec(2 * bands, ACROSS, height_ratios=(0.7, 1.0) * bands)
    for index, (_, example) in enumerate(examples.iterrows()):
        band, column = divmod(index, ACROSS)
        stress = figure.add_subplot(grid[2 * band, column])
        velocity = figure.add_subplot(grid[2 * band + 1, column], sharex=stress)
        rows = table[(table["role"] == "profile") & (table["panel"] == example["series"])]
        curves = {series: part for series, part in rows.groupby("series")}
        before, end = curves["velocity_before"], curves["velocity_end"]
        stress.axhline(0.0, color=GREY, linewidth=0.5, linestyle=":")
        stress.plot(curves["prestress"]["x"], curves["prestress"]["y"], color=BLACK)
        _write_levels(stress, example)
        velocity.plot(before["x"], before["y"], color=GREY, linewidth=0.8, linestyle=EARLIER_DASHES)
        velocity.plot(end["x"], end["y"], color=colours[example["regime"]])
        kind, _, rest = example["regime"].rpartition(", ")
        title = rf"$\bf{{{example['series']}}}$  {kind}," + f"\n    {rest}"
        stress.set_title(title, loc="left", fontsize=7.5, linespacing=1.1)
        stress.set_ylim(-1.2, 1.2)
        stress.set_yticks([0.0, 1.0], ["0", "1"] if column == 0 else ["", ""])
        velocity.set_xlim(curves["prestress"]["x"].min(), curves["prestress"]["x"].max())
        velocity.set_ylim(0.0, 1.15 * max(before["y"].max(), end["y"].max()))
        velocity.locator_params(nbins=3)
        if band == bands - 1:
            velocity.set_xlabel(r"$x$", labelpad=1.0)
        if column == 0:
            stress.set_ylabel(r"$\tau$", labelpad=1.0)
            velocity.set_ylabel(r"$\dot u$", labelpad=1.0)
        for axes in (stress, velocity):
            axes.tick_params(labelsize=7.0, pad=2.0)
        stress.tick_params(bottom=False, labelbottom=False)


def _write_levels(axes, example: pd.Series) -> None:
    """The levels far to the left and right, which may be too close to 0 to see."""
    left, right = example["left"], example["beyond"]
    text = {"fontsize": 7.0, "transform": axes.get_yaxis_transform()}
    for level, x, side in ((left, 0.03, "left"), (right, 0.97, "right")):
        if side == "right" or left != right:
            # Within the panel, beside the line.
            offset, anchor = (0.1, "bottom") if 0.0 <= level < 0.6 else (-0.12, "top")
            label = setting(level)
            axes.text(x, level + offset, label, ha=side, va=anchor, **text)
