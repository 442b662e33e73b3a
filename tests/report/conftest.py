"""Render the report of a small invented run with claims, tables and figures of the right form."""

import re
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import yaml
from pypdf import PdfReader

from slippulse.data.files import CONFIGURATION_VARIABLE
from slippulse.plotting.style import new_panels
from slippulse_paper.claims.kinds import Approximate, Equation, Qualitative
from slippulse_paper.claims.paper_claims import fields_of_claim
from slippulse_paper.claims.rules import Spread, Uncertain
from slippulse_paper.report.manuscript import DOCUMENTS, Inputs
from slippulse_paper.steps import write_report

DIGEST = "0123456789abcdef"
# A claim that is simply reproduced.
FRONT = {"kind": "exact", "tolerance": 1e-3, "source": "runs", "note": "at $x_-$", "sentences": []}
FRONT |= {"statement": r"fronts <outrun> the waves & keep $\gamma<1$", "figure": "fig01_one"}
SPEEDS = {"predicted": 1.25, "measured": 1.2501, "uncertainty": 1e-4}
SPEEDS = {name: np.array([value]) for name, value in SPEEDS.items()}
CLAIM = fields_of_claim(
    "speed", Equation(tolerance=1e-3, counts={"runs": 4}, **SPEEDS), FRONT, "III A"
)


def read(path: Path):
    """Return the content of a YAML file."""
    return yaml.safe_load(path.read_text(encoding="utf-8"))


def invented_claims(entries: dict, config: dict, texts: str, scale: float = 1.0) -> list[dict]:
    """Return a claim for each entry, with every number that a text uses."""
    used = re.findall(r"\.further\[[\"'](.+?)[\"']\]", texts)
    further = {name.replace("\\\\", "\\"): 0.1 for name in used}
    further |= {reading["statement"]: reading["value"] for reading in config["published"].values()}
    shown = {"note": r"measured at $\Delta x=0$", "why": "since $x$ is so"}
    shown["figure"] = "fig05_scaling"
    claims = []
    for i, (id, entry) in enumerate(entries.items(), start=1):
        # The numbers of no two claims are equal.
        deviation = abs(scale * (1.0 + 0.00137 * i) - 1.0)
        medians = {"median": deviation, "ratio": 1.0 + deviation}
        numbers = {name: Uncertain(value, 0.00021) for name, value in medians.items()}
        from_exact = Spread(median=1e-5 * i, largest=2e-5 * i)
        numbers |= {"deviations": 1e-3 * i * np.arange(3.0), "from_exact": from_exact}
        claim = Approximate(tolerance=entry["tolerance"], **numbers, further=further)
        if entry["kind"] == "qualitative":
            claim = Qualitative(decided=[True] * (i - 1) + [None] * 3, further=further)
        statement = rf"{id.replace('_', ' ')}: $T_\mathrm{{trans}}$ is $\pi/\sqrt\gamma$"
        claims.append(fields_of_claim(id, claim, entry | shown | {"statement": statement}, "III A"))
    return claims


def invented_findings(findings: dict[str, str], texts: str) -> list[dict]:
    """Return each finding, with every number that a text uses."""
    variables = "n|late|literal|damped|made_with|collapse|plane|healing|rough"
    names = set(re.findall(rf"\b(?:{variables})\.(\w+)", texts))
    names |= set(re.findall(r'found\("\w+"\)\.(\w+)', texts))
    numbers = {name: 0.0123 * (i + 1) for i, name in enumerate(sorted(names))}
    common = {"numbers": numbers | {"release": "total"}}
    return [common | {"id": id, "text": f"found {id.replace('_', ' ')}"} for id in findings]


def invented_tables(texts: str) -> dict[str, pd.DataFrame]:
    """Return the tables of the report, with every number that its text uses."""

    def row(variable: str) -> dict[str, float]:
        """Return a table row with each column that the texts use of a variable."""
        return dict.fromkeys(re.findall(rf"\b{variable}\.(\w+)", texts), 1.01)

    crack = row("crack")
    transition = {"transition_time": 1.0, "exact_transition_time": 1.0}
    transition |= {"transition_length": 1.0, "exact_transition_length": 1.0}
    quoted = [{"quantity": name, "x": np.nan, "value": 1.01} for name in row("exact")]
    for name in ("release_time", "stick_time", "final_slip"):
        quoted += [{"quantity": name, "x": x, "value": 1.0 + x} for x in (0.0, 1.0)]
    edge = {"family": "level", "value": "tau_0 = 0.999", "quantity": "front speed"}
    edge |= {"error": 1e-4, "tolerance": 1e-2, "verdict": "right", "message": ""}
    tables = {"space_time_displacement": [row("scene")], "space_time_stress": [crack]}
    tables |= {"scaling_displacement": [transition], "derivations": quoted, "extremes": [edge]}
    tables["arrest_path"] = [{"to_go": 1e-6, "time": 2.88} | crack]
    limit = {"scheme": "localised", "order": 5, "damping_ratio": 0.1, "derived": 1.64}
    for name in ("measured", "measured_rupture"):
        limit |= {f"{name}_ratio": 1.01, f"{name}_limit": "within"}
    tables["stability"] = [limit]
    layer_run = {"part": "pulse", "gamma": 0.3, "tau0": 0.8, "weakening": 0.9, "before": np.nan}
    tables["layer"] = [layer_run | {"coupling": 0.0, "cells": 40, "fracture_energy": 0.42}]
    study = {"quantity": "front_speed_right", "value": 1.25}
    known = study | {"uncertainty": 0.0013, "observed_order": 1.04}
    for name in write_report.NEEDS["uncertainties"]:
        tables[f"uncertainties/{name}"] = [known, study]
    return {name: pd.DataFrame(rows) for name, rows in tables.items()}


@pytest.fixture(scope="session")
def manuscript(project) -> Path:
    """Return the folder of the manuscript."""
    return project / "manuscript"


@pytest.fixture(scope="session")
def make_inputs(manuscript, shipped, tmp_path_factory):
    """Return a function that invents a run of a configuration, as inputs of its report."""
    folder = tmp_path_factory.mktemp("figures")
    figures = [name for name in read(manuscript / "captions.yaml") if name.startswith("fig")]
    drawn, (axes,) = new_panels(3.4, 2.0, "a")
    axes.plot(np.arange(3))
    for name in figures:
        for ending in ("png", "pdf"):
            drawn.savefig(folder / f"{name}.{ending}")
    entries = read(manuscript / "claims.yaml")
    texts = "\n".join(path.read_text("utf-8") for path in sorted(manuscript.glob("*.[my]*")))

    def make(config: dict = shipped, scale: float = 1.0) -> Inputs:
        return Inputs(
            config=config,
            shipped=shipped,
            claims=invented_claims(entries["claims"], config, texts, scale),
            findings=invented_findings(entries["findings"], texts),
            tables=invented_tables(texts),
            figures=figures,
            figures_folder=folder,
            manuscript=manuscript,
            citation=read(manuscript.parent / "CITATION.cff"),
        )

    return make


@pytest.fixture(scope="session")
def build(tmp_path_factory):
    """Return a function that writes a report and returns its files, inputs and claims."""

    def made(inputs: Inputs) -> SimpleNamespace:
        folder = tmp_path_factory.mktemp("report")
        outputs = {
            "html": [folder / f"{name}.html" for name in DOCUMENTS],
            "pdf": [folder / f"{name}.pdf" for name in DOCUMENTS],
            "verdicts": folder / "verdicts",
        }
        with pytest.MonkeyPatch.context() as patch:
            patch.setenv(CONFIGURATION_VARIABLE, DIGEST)
            patch.setattr(write_report, "inputs_of", lambda files, settings: inputs)
            write_report.run({}, outputs, {})
        pages = [path.read_text(encoding="utf-8") for path in outputs["html"]]
        claims = {claim["id"]: claim for claim in inputs.claims}
        pdfs = [PdfReader(path) for path in outputs["pdf"]]
        return SimpleNamespace(**outputs, inputs=inputs, claims=claims, pages=pages, pdfs=pdfs)

    return made


@pytest.fixture(scope="session")
def report(make_inputs, build) -> SimpleNamespace:
    """Return the report of an invented run of the shipped configuration."""
    return build(make_inputs())
