"""Snakemake's own records of what each job took."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import pandas as pd


def read_job_records(folder: str | Path) -> pd.DataFrame:
    """One row a job: rule (its folder, or its name), job, seconds, processor seconds, memory (MB).

    Parameters
    ----------
    folder : where the pipeline's benchmark files are
    """
    # Slow to load, and every start of the workflow loads this module.
    import pandas as pd

    folder = Path(folder)
    rows = []
    for path in sorted(folder.rglob("*.tsv")):
        inside = path.relative_to(folder)
        record = pd.read_csv(path, sep="\t", na_values="-").iloc[-1]
        rows.append(
            {
                "rule": inside.parts[0] if len(inside.parts) > 1 else inside.stem,
                "job": str(inside.with_suffix("").as_posix()),
                "seconds": float(record["s"]),
                "processor_seconds": float(record.get("cpu_time", "nan")),
                "memory": float(record.get("max_rss", "nan")),
            }
        )
    return pd.DataFrame(rows, columns=["rule", "job", "seconds", "processor_seconds", "memory"])
