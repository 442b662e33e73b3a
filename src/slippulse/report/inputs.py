"""What the report is written from: the ledger, tables, figures, configuration and the texts beside it."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import pandas as pd
import yaml

from ..data.store import load_table


@dataclass(frozen=True)
class Inputs:
    """Files and settings behind one report.

    Attributes
    ----------
    config : the configuration of the run, builtins
    claims_file : the ledger, JSON
    findings_file : what was found beside, JSON
    measured, uncertainties : per simulation, a CSV table; among the measured the study of the edges, extremes
    figures : names of the figures to include, in any order
    figures_folder : where their files are
    manuscript : folder of the texts: captions, errata, shipped verdicts
    shipped_config : the configuration as shipped, YAML
    """

    config: Mapping
    claims_file: str
    findings_file: str
    measured: Mapping[str, str]
    uncertainties: Mapping[str, str]
    figures: list[str]
    figures_folder: str
    manuscript: str
    shipped_config: str

    @classmethod
    def of_project(cls, project: Path) -> Inputs:
        """Whatever a finished run left in the results folder of a project."""
        results, settings = project / "results", project / "config/config.yaml"
        manuscript = project / "manuscript"
        captions = yaml.safe_load((manuscript / "captions.yaml").read_text(encoding="utf-8"))
        return cls(
            config=yaml.safe_load(settings.read_text(encoding="utf-8")),
            claims_file=str(results / "claims.json"),
            findings_file=str(results / "findings.json"),
            measured={
                p.stem: str(p)
                for name in ("measurements", "studies")
                for p in sorted((results / name).glob("*.csv"))
            },
            uncertainties={p.stem: str(p) for p in sorted((results / "uncertainties").glob("*.csv"))},
            figures=[name for name in captions if (results / f"figures/{name}.pdf").exists()],
            figures_folder=str(results / "figures"),
            manuscript=str(manuscript),
            shipped_config=str(settings),
        )

    @cached_property
    def claims(self) -> list[dict]:
        """The ledger, in its own order."""
        return json.loads(Path(self.claims_file).read_text(encoding="utf-8"))

    @cached_property
    def findings(self) -> list[dict]:
        """What was found beside: numbers of ours, by finding."""
        return json.loads(Path(self.findings_file).read_text(encoding="utf-8"))

    @cached_property
    def statements(self) -> list[dict]:
        """The sentences of the paper that assert something, in their order."""
        return yaml.safe_load(self.text("statements.yaml"))["statements"]

    @cached_property
    def shipped(self) -> dict:
        """The configuration as shipped."""
        return yaml.safe_load(Path(self.shipped_config).read_text(encoding="utf-8"))

    @cached_property
    def shipped_verdicts(self) -> dict[str, str]:
        """Verdict of each claim in the report that is shipped."""
        return yaml.safe_load(self.text("shipped_verdicts.yaml")) or {}

    @cached_property
    def errata(self) -> list[dict]:
        """Entries of the errata."""
        return yaml.safe_load(self.text("errata.yaml"))

    def text(self, name: str) -> str:
        """A text beside the manuscript."""
        return (Path(self.manuscript) / name).read_text(encoding="utf-8")

    def table(self, simulation: str) -> pd.DataFrame:
        """Measured numbers of one simulation, one row a run.

        Raises
        ------
        ValueError
            Naming the simulation and those that the report has.
        """
        return load_table(_one_of(self.measured, simulation))

    def study(self, simulation: str) -> pd.DataFrame:
        """Grid study of one simulation, one row a number of a run; an unknown name is refused as in `table`."""
        return load_table(_one_of(self.uncertainties, simulation))


def _one_of(paths: Mapping[str, str], simulation: str) -> str:
    if simulation not in paths:
        raise ValueError(f"simulation: {simulation!r}; allowed: {', '.join(sorted(paths))}")
    return paths[simulation]
