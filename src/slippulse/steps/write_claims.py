"""Compute every claim's verdict and what was found beside, as JSON and as a page to read."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import yaml

from ..claims.evidence import Evidence
from ..claims.findings import findings
from ..claims.paper import all_claims, finite
from ..data.files import write_text
from ..report.claims_page import claims_page
from .inputs import given

FILES = (
    "report/templates/base.html",
    "report/templates/claims.html",
    "report/templates/parts.html",
    "report/templates/style.css",
)


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: as `given` takes them, texts, statements. Outputs: json, findings, html.

    Settings: claims (tolerances in place of those with the texts), measure, published, damping_ratio, altered.
    """
    texts = yaml.safe_load(Path(files["texts"]).read_text(encoding="utf-8"))
    sentences = yaml.safe_load(Path(files["statements"]).read_text(encoding="utf-8"))["statements"]
    entries = {id: entry | settings["claims"].get(id, {}) for id, entry in texts["claims"].items()}
    _, tables = given(files)
    evidence = Evidence.of(tables, entries, settings["measure"]["steady_tolerance"])
    claims = all_claims(evidence, settings["published"], sentences)
    beside = finite(findings(evidence, settings["damping_ratio"], texts["findings"]))
    write_text(json.dumps(claims, indent=1, ensure_ascii=False) + "\n", outputs["json"])
    write_text(json.dumps(beside, indent=1, ensure_ascii=False) + "\n", outputs["findings"])
    write_text(claims_page(claims, settings["altered"], beside), outputs["html"])
