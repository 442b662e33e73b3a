"""Data and tables that a figure or a study is made from, by name, whatever the step."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pandas as pd
import xarray as xr
import yaml

from ..data.store import load_dataset, load_table


def given(files: Mapping) -> tuple[dict[str, xr.Dataset], dict[str, pd.DataFrame]]:
    """Datasets of simulations, and tables.

    Parameters
    ----------
    files : data, measured, predicted, studies, coarser, uncertainties, and lists of entries (YAML or JSON): lists of
        paths; what is missing is none

    Returns
    -------
    datasets by simulation; tables by simulation or study, predictions joined to the measurements of the same runs,
    and those of grid studies as uncertainties/NAME and coarser/NAME
    """

    def loaded(kind: str, prefix: str = "") -> dict[str, pd.DataFrame]:
        return {f"{prefix}{Path(path).stem}": load_table(path) for path in files.get(kind, [])}

    tables = loaded("measured") | loaded("studies")
    for name, predicted in loaded("predicted").items():
        tables[name] = tables[name].join(predicted) if name in tables else predicted
    for path in map(Path, files.get("lists", [])):
        read = json.loads if path.suffix == ".json" else yaml.safe_load
        tables[path.stem] = pd.DataFrame(read(path.read_text(encoding="utf-8")))
    tables |= loaded("uncertainties", "uncertainties/") | loaded("coarser", "coarser/")
    return {Path(path).stem: load_dataset(path) for path in files.get("data", [])}, tables
