"""Compute the verdict of every claim and the further findings, as JSON and as a page."""

from pathlib import Path

from slippulse.data.files import write_text

from ..claims.claim_texts import read_entries, read_text
from ..claims.evidence import Evidence
from ..claims.findings import findings
from ..claims.paper_claims import all_claims, finite
from ..records.job_records import write_json
from ..report.claims_page import claims_page
from .inputs import load_inputs


def run(files: dict, outputs: dict, settings: dict) -> None:
    """Write the claims with their verdicts (``json``), the ``findings``, and the page ``html``.

    The files are the tables that `load_inputs` reads, and two files of the manuscript (``texts``
    and ``statements``). The settings have the blocks ``claims``, ``published`` and ``measure`` of
    the configuration, the damping ratio, and the list of altered values.
    """
    texts = read_entries(files["texts"], settings["claims"])
    sentences = read_text(files["statements"])["statements"]
    tables = load_inputs(files).tables
    steady_tolerance = settings["measure"]["steady_tolerance"]
    readings = settings["published"]
    evidence = Evidence(tables, texts["claims"], steady_tolerance, readings)
    claims = all_claims(evidence, texts["over_choices"], sentences)
    further_findings = finite(findings(evidence, settings["damping_ratio"], texts["findings"]))
    write_json(claims, outputs["json"])
    write_json(further_findings, outputs["findings"])
    paths = files["measured"] + files["predicted"] + files["uncertainties"] + files["studies"]
    folder = Path(outputs["html"]).parent
    links = [Path(path).relative_to(folder).as_posix() for path in paths]
    write_text(claims_page(claims, settings["altered"], further_findings, links), outputs["html"])
