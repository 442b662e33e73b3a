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

    The files are the tables that `load_inputs` reads, and two files of the manuscript: ``texts``
    (claims and findings in words) and ``statements`` (sentences of the paper). The settings have
    the blocks ``claims`` (tolerances), ``published`` (numbers that were read off the paper's
    figures) and ``measure`` of the configuration, the damping ratio, and the altered values.
    """
    texts = read_entries(files["texts"], tolerances=settings["claims"])
    sentences = read_text(files["statements"])["statements"]
    # Everything by which the claims are judged.
    evidence = Evidence(
        tables=load_inputs(files).tables,
        entries=texts["claims"],
        steady=settings["measure"]["steady_tolerance"],
        readings=settings["published"],
    )
    claims = all_claims(evidence, explanations=texts["over_choices"], sentences=sentences)
    # JSON has no NaN and no infinity. `finite` replaces them by None.
    further_findings = finite(findings(evidence, settings["damping_ratio"], texts["findings"]))
    write_json(claims, outputs["json"])
    write_json(further_findings, outputs["findings"])
    # The page has links to all tables.
    paths = files["measured"] + files["predicted"] + files["uncertainties"] + files["studies"]
    folder = Path(outputs["html"]).parent
    links = [Path(path).relative_to(folder).as_posix() for path in paths]
    write_text(claims_page(claims, settings["altered"], further_findings, links), outputs["html"])
