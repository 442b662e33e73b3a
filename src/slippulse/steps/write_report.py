"""Write the replication report as HTML and PDF."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from ..report.build import build_report
from ..report.inputs import Inputs

# Whose measured numbers and uncertainties the report quotes.
SIMULATIONS = ["scaling_displacement", "scaling_stress", "steady_displacement"]


def run(files: Mapping, outputs: Mapping, settings: Mapping) -> None:
    """Files: source, claims, findings, shipped, measured, uncertainties, figures. Outputs: html, pdf, verdicts."""

    def absolute(path: str | Path) -> str:
        return str(Path(path).resolve())

    inputs = Inputs(
        config=settings["config"],
        claims_file=absolute(files["claims"]),
        findings_file=absolute(files["findings"]),
        measured={Path(path).stem: absolute(path) for path in files["measured"]},
        uncertainties={Path(path).stem: absolute(path) for path in files["uncertainties"]},
        figures=list(settings["figures"]),
        figures_folder=absolute(Path(files["figures"][0]).parent),
        manuscript=absolute(Path(files["source"]).parent),
        shipped_config=absolute(files["shipped"]),
    )
    build_report(inputs, outputs)
