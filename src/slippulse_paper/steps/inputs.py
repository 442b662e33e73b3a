"""Data and tables that a figure, a study or a page is made from, by name, whatever the step."""

import json
from collections.abc import Mapping
from pathlib import Path

import pandas as pd
import xarray as xr
import yaml

from slippulse.data.store import load_dataset
from slippulse.data.tables import load_table


def given(files: Mapping) -> tuple[dict[str, xr.Dataset], dict[str, pd.DataFrame]]:
    """Load Datasets and tables by name, from lists of paths by kind; predictions are joined."""
    tables: dict[str, pd.DataFrame] = {}
    for kind in ("measured", "studies", "predicted", "uncertainties", "coarser"):
        for path in map(Path, files.get(kind, [])):
            name = f"{kind}/{path.stem}" if kind in ("uncertainties", "coarser") else path.stem
            table = load_table(path)
            joined = kind == "predicted" and name in tables
            tables[name] = tables[name].join(table) if joined else table
    for path in map(Path, files.get("lists", [])):
        read = json.loads if path.suffix == ".json" else yaml.safe_load
        tables[path.stem] = pd.DataFrame(read(path.read_text(encoding="utf-8")))
    return {Path(path).stem: load_dataset(path) for path in files.get("data", [])}, tables
