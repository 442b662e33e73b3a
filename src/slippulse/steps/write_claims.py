"""Compute every claim's verdict and what was found beside, as JSON and as a page to read."""

from pathlib import Path

from ..claims.evidence import Evidence
from ..claims.findings import findings
from ..claims.paper import all_claims, finite
from ..claims.reading import read_entries, read_text
from ..data.files import write_json, write_text
from ..report.claims_page import claims_page
from .inputs import given

FILES = ("report/templates/claims.html", "report/templates/parts.html")


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: as `given` takes them, texts, statements. Outputs: json, findings, html.

    Settings: claims (tolerances in place of those with the texts), measure, published, damping_ratio, altered.
    """
    texts = read_entries(files["texts"], settings["claims"])
    sentences = read_text(files["statements"])["statements"]
    _, tables = given(files)
    steady = settings["measure"]["steady_tolerance"]
    evidence = Evidence(tables, texts["claims"], steady, settings["published"])
    claims = all_claims(evidence, sentences)
    beside = finite(findings(evidence, settings["damping_ratio"], texts["findings"]))
    write_json(claims, outputs["json"])
    write_json(beside, outputs["findings"])
    here = Path(outputs["html"]).parent
    listed = [
        path
        for kind in ("measured", "predicted", "uncertainties", "studies")
        for path in files[kind]
    ]
    tables_of = [Path(path).relative_to(here).as_posix() for path in listed]
    write_text(claims_page(claims, settings["altered"], beside, tables_of), outputs["html"])
