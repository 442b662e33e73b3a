"""What the report is written from: the ledger, tables, figures, configuration and the texts beside it."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import pandas as pd
import yaml

from ..data.store import load_table

# Where the executed notebook finds the list of its inputs; without it, the results folder beside it is read.
VARIABLE = "SLIPPULSE_REPORT_INPUTS"


@dataclass(frozen=True)
class Inputs:
    """Files and settings behind one report.

    Attributes
    ----------
    config : the configuration of the run, builtins
    claims_file : the ledger, JSON
    measured, uncertainties : per simulation, a CSV table
    figures : names of the figures to include, in any order
    figures_folder : where their files are
    manuscript : folder of the texts: captions, errata, shipped verdicts
    shipped_config : the configuration as shipped, YAML
    """

    config: Mapping
    claims_file: str
    measured: Mapping[str, str]
    uncertainties: Mapping[str, str]
    figures: list[str]
    figures_folder: str
    manuscript: str
    shipped_config: str
    _tables: dict = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def current(cls) -> Inputs:
        """The inputs that the environment names, or the results beside the notebook when opened by hand."""
        if VARIABLE in os.environ:
            return cls.read(os.environ[VARIABLE])
        project = next(p for p in (Path.cwd(), *Path.cwd().parents) if (p / "config/config.yaml").exists())
        return cls.of_project(project)

    @classmethod
    def of_project(cls, project: Path) -> Inputs:
        """Whatever a finished run left in the results folder of a project."""
        results = project / "results"
        return cls(
            config=yaml.safe_load((project / "config/config.yaml").read_text(encoding="utf-8")),
            claims_file=str(results / "claims.json"),
            measured={p.stem: str(p) for p in sorted((results / "measurements").glob("*.csv"))},
            uncertainties={p.stem: str(p) for p in sorted((results / "uncertainties").glob("*.csv"))},
            figures=sorted(p.stem for p in (results / "figures").glob("*.pdf")),
            figures_folder=str(results / "figures"),
            manuscript=str(project / "manuscript"),
            shipped_config=str(project / "config/config.yaml"),
        )

    @classmethod
    def read(cls, path: str | Path) -> Inputs:
        """From the file that `write` made."""
        return cls(**json.loads(Path(path).read_text(encoding="utf-8")))

    def write(self, path: str | Path) -> None:
        """Hand the inputs to another process."""
        entries = {key: getattr(self, key) for key in self.__dataclass_fields__ if key != "_tables"}
        Path(path).write_text(json.dumps(entries), encoding="utf-8")

    @cached_property
    def claims(self) -> list[dict]:
        """The ledger, in its own order."""
        return json.loads(Path(self.claims_file).read_text(encoding="utf-8"))

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

    @cached_property
    def captions(self) -> dict[str, str]:
        """Caption of each figure."""
        return yaml.safe_load(self.text("captions.yaml"))

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
        return self._load("measured", simulation)

    def study(self, simulation: str) -> pd.DataFrame:
        """Grid study of one simulation, one row a number of a run."""
        return self._load("uncertainties", simulation)

    def _load(self, kind: str, simulation: str) -> pd.DataFrame:
        paths = getattr(self, kind)
        if simulation not in paths:
            raise ValueError(f"{kind}: {simulation!r}; allowed: {', '.join(sorted(paths))}")
        if (kind, simulation) not in self._tables:
            self._tables[kind, simulation] = load_table(paths[simulation])
        return self._tables[kind, simulation]
