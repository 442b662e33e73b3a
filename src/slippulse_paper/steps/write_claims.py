"""Compute the verdict of every claim and the further findings, as JSON and as a page."""

from pathlib import Path

from slippulse.data.files import write_text

from ..claims.claim_texts import read_entries, read_text
from ..claims.evidence import Evidence
from ..claims.findings import findings
from ..claims.paper_claims import all_claims, finite
from ..records.job_records import write_json
from ..report.claims_page import claims_page
from .inputs import given


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Files: as of `given`; texts, statements. Outputs: json, findings, html."""
    texts = read_entries(files["texts"], settings["claims"])
    sentences = read_text(files["statements"])["statements"]
    _, tables = given(files)
    steady = settings["measure"]["steady_tolerance"]
    evidence = Evidence(tables, texts["claims"], steady, settings["published"])
    claims = all_claims(evidence, texts["over_choices"], sentences)
    beside = finite(findings(evidence, settings["damping_ratio"], texts["findings"]))
    write_json(claims, outputs["json"])
    write_json(beside, outputs["findings"])
    paths = files["measured"] + files["predicted"] + files["uncertainties"] + files["studies"]
    folder = Path(outputs["html"]).parent
    links = [Path(path).relative_to(folder).as_posix() for path in paths]
    write_text(claims_page(claims, settings["altered"], beside, links), outputs["html"])
