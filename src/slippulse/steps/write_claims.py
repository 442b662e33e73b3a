"""Compute every claim's verdict and write the ledger, as JSON and as a page to read."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pandas as pd

from ..claims.evidence import Evidence
from ..claims.paper import all_claims
from ..data.files import write_text
from ..data.store import load_table
from ..pages.claims import claims_page

FILES = (
    "pages/templates/base.html",
    "pages/templates/claims.html",
    "pages/templates/parts.html",
    "pages/templates/style.css",
)


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: measured, coarser, uncertainties. Outputs: json, html. Settings: claims, share, published, altered."""
    coarser = {name: _by_factor(table) for name, table in _tables(files["coarser"]).items()}
    evidence = Evidence(
        _tables(files["measured"]), coarser, _tables(files["uncertainties"]), settings["claims"]
    )
    found = all_claims(evidence, settings["share"], settings["published"])
    claims = [claim.as_dict() for claim in found]
    write_text(json.dumps(claims, indent=1, ensure_ascii=False) + "\n", outputs["json"])
    write_text(claims_page(claims, settings["altered"]), outputs["html"])


def _tables(paths: list[str]) -> dict[str, pd.DataFrame]:
    return {Path(path).stem: load_table(path) for path in paths}


def _by_factor(table: pd.DataFrame) -> list[pd.DataFrame]:
    return [part.reset_index(drop=True) for _, part in table.groupby("factor")]
