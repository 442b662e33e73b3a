"""Compute every claim's verdict and what was found beside, as JSON and as a page to read."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import pandas as pd
import yaml

from ..claims.evidence import Evidence
from ..claims.findings import findings
from ..claims.ledger import finite
from ..claims.paper import all_claims
from ..data.files import write_text
from ..data.store import load_table
from ..report.claims_page import claims_page

FILES = ("report/templates/claims.html", "report/templates/parts.html")


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: measured, coarser, uncertainties, study, texts, statements. Outputs: json, findings, html.

    Settings: claims, measure, published, damping_ratio, altered.
    """
    measure = settings["measure"]
    coarser = {name: _by_factor(table) for name, table in _tables(files["coarser"]).items()}
    evidence = Evidence(
        _tables(files["measured"]), coarser, _tables(files["uncertainties"]), settings["claims"],
        measure["steady_tolerance"], measure["still"],
    )  # fmt: skip
    texts = yaml.safe_load(Path(files["texts"]).read_text(encoding="utf-8"))
    statements = yaml.safe_load(Path(files["statements"]).read_text(encoding="utf-8"))["statements"]
    study, readings = load_table(files["study"]), settings["published"]
    found = all_claims(evidence, measure["share"], readings, study, texts["claims"], statements)
    claims = [claim.as_dict() for claim in found]
    beside = finite(findings(evidence, settings["damping_ratio"], measure["share"], study, texts["findings"]))
    write_text(json.dumps(claims, indent=1, ensure_ascii=False) + "\n", outputs["json"])
    write_text(json.dumps(beside, indent=1, ensure_ascii=False) + "\n", outputs["findings"])
    write_text(claims_page(claims, settings["altered"], beside), outputs["html"])


def _tables(paths: list[str]) -> dict[str, pd.DataFrame]:
    return {Path(path).stem: load_table(path) for path in paths}


def _by_factor(table: pd.DataFrame) -> list[pd.DataFrame]:
    return [part.reset_index(drop=True) for _, part in table.groupby("factor")]
