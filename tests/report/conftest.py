"""A report made from a small invented run: a ledger, tables and figures of the right form, executed and rendered."""

from __future__ import annotations

import copy
import json
import re
import shutil
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
import yaml
from matplotlib.figure import Figure

from slippulse.claims.rules import within
from slippulse.configuration.expand import expand, resolve
from slippulse.data.origin import configured_by
from slippulse.data.store import save_table
from slippulse.measure.uncertainty import grid_tables
from slippulse.report.build import build_report
from slippulse.report.inputs import Inputs
from slippulse.theory import front_speed, steady_pulse

SIMULATIONS = ("scaling_displacement", "scaling_stress", "steady_displacement")
EDGE = {
    "family": "level", "value": "tau_0 = 0.999", "quantity": "front speed", "error": 1e-4, "tolerance": 1e-2,
    "verdict": "right", "message": "",
}  # fmt: skip
# Names of further numbers that the texts ask for.
FURTHER = (
    "median gap in H", "slip off by at most", "peak on the lattice, with damping, off by at most",
    "half-width on the lattice, with damping, off by at most", r"$\mu_k/(\mu_s-\mu_k)$ needed",
    r"at $\tau_{0,r}=0$, without a verdict: pulse, one-way, decaying",
)  # fmt: skip
KEYS = ("left", "gamma", "beta", "damping_ratio", "release")


def invented_claims(config: dict, scale: float = 1.0) -> list[dict]:
    """One entry for each claim of the configuration, each with numbers of its own."""
    claims = []
    further = {r"$\beta/\Delta x$": 0.1} | {name: 0.1 for name in FURTHER}
    further |= {reading["statement"]: reading["value"] for reading in config["published"].values()}
    for i, (id, entry) in enumerate(config["claims"].items()):
        deviation = abs(scale * (1.0 + 0.00137 * (i + 1)) - 1.0)
        runs = {"held": i, "failed": 0, "undecided": 3} if entry["kind"] == "qualitative" else {}
        claims.append(
            {
                "id": id,
                "figure_or_section": "section III A",
                "statement": rf"statement of {id.replace('_', ' ')}: $T_\mathrm{{trans}}$ is $\pi/\sqrt\gamma$",
                "kind": entry["kind"],
                "counted": "follows_from" not in entry,
                "follows_from": entry.get("follows_from", []),
                "predicted": 1.0,
                "measured": 1.0 + deviation,
                "uncertainty": 0.00021,
                "tolerance": entry["tolerance"],
                "deviation": deviation,
                "verdict": within(deviation, 0.00021, entry["tolerance"]),
                "why": "since $x$ is so",
                "note": r"measured at $\Delta x=0$",
                "source": "invented",
                "runs": i + 3,
                "left_out": i % 2,
                "held": None,
                "failed": None,
                "undecided": None,
                "ninety": 1e-3 * (i + 1),
                "largest": 2e-3 * (i + 1),
                "exponent": 1.01 if "tolerance_exponent" in entry else None,
                "exponent_uncertainty": 0.002,
                "tolerance_exponent": entry.get("tolerance_exponent"),
                "exact_median": 1e-5 * (i + 1),
                "exact_largest": 2e-5 * (i + 1),
                "further": further,
                "figure": "fig05_scaling",
            }
            | runs
        )
    return claims


def invented_findings(project: Path) -> list[dict]:
    """Each finding of the texts with a number of its own for everything that any text asks of it."""
    findings = yaml.safe_load((project / "manuscript/claims.yaml").read_text(encoding="utf-8"))["findings"]
    names = set(re.findall(r"\bn\.(\w+)", " ".join(findings.values())))
    names |= {"displacement_undamped", "stress_undamped"}
    numbers = {name: 0.0123 * (i + 1) for i, name in enumerate(sorted(names))} | {"release": "total"}
    return [{"id": id, "numbers": numbers, "text": f"found {id.replace('_', ' ')}"} for id in findings]


def invented_table(config: dict, simulation: str, error: float) -> pd.DataFrame:
    """Measured numbers of a simulation block: theory with an error added, so that every column exists."""
    accuracy = config["presets"][config["preset"]]
    scenes, _ = expand(resolve(config["simulations"][simulation], config["model"], accuracy))
    rows = []
    for i, scene in enumerate(scenes):
        row = {
            "left": scene.prestress.left,
            "gamma": scene.gamma,
            "beta": scene.beta,
            "damping_ratio": scene.damping_ratio,
            "release": scene.release,
            "transition_time": 3.0 + error,
            "transition_length": 9.0 + error,
            "slip_time_background": 2.0 if i % 2 else float("nan"),
            "slip_time_nucleation": float("nan"),
            "balance_distance": 2.0,
            "last_release_time": 3.1 + 0.01 * i + error,
        }
        if simulation == "steady_displacement":
            speed = front_speed(row["left"], row["damping_ratio"], row["release"])
            pulse = steady_pulse(row["left"], row["gamma"], row["beta"], speed)
            row |= {
                "front_speed_right": speed + error,
                "pulse_peak_velocity": pulse.peak_velocity + error,
                "pulse_slip": pulse.slip + error,
                "pulse_width": pulse.width + error,
            }
        rows.append(row)
    return pd.DataFrame(rows)


@pytest.fixture(scope="session")
def shipped(project) -> dict:
    """The shipped configuration."""
    return yaml.safe_load((project / "config/config.yaml").read_text(encoding="utf-8"))


@pytest.fixture(scope="session")
def pictures(tmp_path_factory) -> list[Path]:
    """A picture as PDF and PNG."""
    figure = Figure(figsize=(4, 2))
    figure.add_subplot().plot(np.arange(3))
    paths = [tmp_path_factory.mktemp("pictures") / f"picture.{ending}" for ending in ("pdf", "png")]
    for path in paths:
        figure.savefig(path)
    return paths


@pytest.fixture(scope="session")
def make_inputs(project, shipped, pictures, tmp_path_factory):
    """A function that writes the files of an invented run and returns them as inputs of the report."""

    def make(config: dict | None = None, scale: float = 1.0, figures: list[str] | None = None) -> Inputs:
        folder = tmp_path_factory.mktemp("run")
        config = copy.deepcopy(config or shipped)
        (folder / "claims.json").write_text(json.dumps(invented_claims(config, scale)), encoding="utf-8")
        (folder / "findings.json").write_text(json.dumps(invented_findings(project)), encoding="utf-8")
        measured, studies = {}, {}
        for name in SIMULATIONS:
            tables = tuple(invented_table(config, name, error) for error in (1e-3, 2e-3, 4e-3))
            measured[name] = str(folder / f"{name}.csv")
            save_table(tables[0], measured[name])
            studies[name] = str(folder / f"{name}_study.csv")
            save_table(grid_tables(tables, (2.0, 4.0), KEYS), studies[name])
        measured["extremes"] = str(folder / "extremes.csv")
        save_table(pd.DataFrame([EDGE]), measured["extremes"])
        captions = yaml.safe_load((project / "manuscript/captions.yaml").read_text(encoding="utf-8"))
        figures = figures if figures is not None else [name for name in captions if name.startswith("fig")]
        for name in figures:
            for picture in pictures:
                shutil.copyfile(picture, folder / f"{name}{picture.suffix}")
        return Inputs(
            config=config,
            claims_file=str(folder / "claims.json"),
            findings_file=str(folder / "findings.json"),
            measured=measured,
            uncertainties=studies,
            figures=figures,
            figures_folder=str(folder),
            manuscript=str(project / "manuscript"),
            shipped_config=str(project / "config/config.yaml"),
        )

    return make


@pytest.fixture(scope="session")
def digest() -> str:
    """Of the configuration behind a report."""
    return "0123456789abcdef"


@pytest.fixture(scope="session")
def build(tmp_path_factory, digest):
    """A function that builds a report and returns its files' paths and its ledger."""

    def made(inputs: Inputs) -> SimpleNamespace:
        folder = tmp_path_factory.mktemp("report")
        outputs = {
            "html": folder / "replication.html",
            "pdf": folder / "replication.pdf",
            "verdicts": folder / "verdicts.yaml",
        }
        with configured_by(digest):
            build_report(inputs, outputs)
        return SimpleNamespace(
            **outputs, inputs=inputs, claims={claim["id"]: claim for claim in inputs.claims}
        )

    return made


@pytest.fixture(scope="session")
def report(make_inputs, build) -> SimpleNamespace:
    """The report of an invented run of the shipped configuration."""
    return build(make_inputs())


@pytest.fixture(scope="session")
def manuscript(project) -> Path:
    """The folder of the report's texts."""
    return project / "manuscript"
