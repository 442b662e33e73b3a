"""Where the pipeline's time goes, from Snakemake's own records."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from ..data.job_times import read_records
from .style import BLUE, GREEN, GREY, ORANGE, PAGE, new_figure, panel_letter

# Jobs shown one by one.
LONGEST = 20


def table(benchmarks: str | Path, results: str | Path) -> pd.DataFrame:
    """One row a job, and what was recorded against what is drawn.

    Parameters
    ----------
    benchmarks : folder of Snakemake's benchmark files
    results : folder of the results; its netCDF files are what was recorded, the figures' CSVs what is drawn

    Returns
    -------
    part "job": rule, job, seconds, processor_seconds, memory (MB); part "bytes": rule "recorded" or "drawn", bytes
    """
    jobs = read_records(benchmarks).assign(part="job")
    results = Path(results)
    sizes = {
        "recorded": sum(path.stat().st_size for path in (results / "data").rglob("*.nc")),
        "drawn": sum(path.stat().st_size for path in (results / "figures").glob("*.csv")),
    }
    rows = pd.DataFrame({"part": "bytes", "rule": list(sizes), "bytes": list(sizes.values())})
    return pd.concat([jobs, rows], ignore_index=True)


def plot(table: pd.DataFrame) -> Figure:
    """Left: seconds of all jobs of a rule. Right: the longest jobs, elapsed and on the processor."""
    figure = new_figure(PAGE, 4.6)
    # Names of rules are longer than what the layout reserves for ticks before they are drawn.
    figure.get_layout_engine().set(rect=(0.03, 0.0, 0.97, 1.0))
    left, right = figure.subplots(1, 2)
    jobs = table[table["part"] == "job"]
    by_rule = jobs.groupby("rule")["seconds"].agg(["sum", "count"]).sort_values("sum", ascending=False)
    places = np.arange(len(by_rule))
    left.barh(places, by_rule["sum"], color=BLUE, gid="rule")
    left.set_yticks(
        places, [f"{rule} ({count})" if count > 1 else rule for rule, count in by_rule["count"].items()]
    )
    left.set_xlabel("seconds, all jobs of a rule")
    left.text(
        0.97, 0.03, f"{by_rule['sum'].sum():.0f} s in all\n{notes(table)}", ha="right", va="bottom", fontsize=6.5,
        transform=left.transAxes,
    )  # fmt: skip

    longest = jobs.sort_values("seconds", ascending=False).head(LONGEST)
    places = np.arange(len(longest))
    right.barh(places, longest["seconds"], color=ORANGE, label="elapsed", gid="job")
    right.barh(
        places, longest["processor_seconds"], height=0.35, color=GREEN, label="processor", gid="processor"
    )
    right.set_yticks(places, longest["job"].str.replace("_displacement", "_disp.").str.replace("/", ": "))
    right.set_xlabel("seconds, longest jobs")
    right.legend(loc="lower right")
    for axes, letter in ((left, "a"), (right, "b")):
        axes.tick_params(axis="y", labelsize=6.0, length=0.0)
        axes.invert_yaxis()
        axes.grid(axis="x", color=GREY, alpha=0.3, linewidth=0.4)
        panel_letter(axes, letter)
    return figure


def notes(table: pd.DataFrame) -> str:
    """Largest memory, and bytes recorded against drawn, in three lines."""
    sizes = table[table["part"] == "bytes"].set_index("rule")["bytes"] / 1e6
    memory = table["memory"].max()
    return (
        f"largest memory {memory:.0f} MB\nrecorded {sizes['recorded']:.0f} MB\ndrawn {sizes['drawn']:.1f} MB"
    )
