"""Loading of the data and tables that a figure, a study or a page is made from."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import pandas as pd
import xarray as xr
import yaml

from slippulse.data.store import load_dataset
from slippulse.data.tables import load_table


class LoadedInputs(NamedTuple):
    """Data of simulations, and tables, by name."""

    data: dict[str, xr.Dataset]
    tables: dict[str, pd.DataFrame]


def load_inputs(files: Mapping) -> LoadedInputs:
    """Load the data of simulations, and tables, by the names of their files.

    ``files`` has a list of paths for each kind of file. The predictions for a simulation are joined
    to its measured table. Tables of uncertainties and of coarser lattices have their kind in the
    name, such as ``coarser/arrest``. JSON and YAML files of the kind ``lists`` become tables, too.
    """
    tables: dict[str, pd.DataFrame] = {}
    for kind in ("measured", "studies"):
        for path in map(Path, files.get(kind, [])):
            tables[path.stem] = load_table(path)
    for path in map(Path, files.get("predicted", [])):
        predicted = load_table(path)
        measured = tables.get(path.stem)
        tables[path.stem] = predicted if measured is None else measured.join(predicted)
    for kind in ("uncertainties", "coarser"):
        for path in map(Path, files.get(kind, [])):
            tables[f"{kind}/{path.stem}"] = load_table(path)
    for path in map(Path, files.get("lists", [])):
        parse = json.loads if path.suffix == ".json" else yaml.safe_load
        tables[path.stem] = pd.DataFrame(parse(path.read_text(encoding="utf-8")))
    data = {Path(path).stem: load_dataset(path) for path in files.get("data", [])}
    return LoadedInputs(data, tables)
