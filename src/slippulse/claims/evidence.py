"""The measured numbers and their uncertainties, as a claim asks for them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from .ledger import Claim, judge

NAN = float("nan")


def compared(claim: Claim, values: Sequence[float], exact: Sequence[float]) -> Claim:
    """The claim with the median and the largest relative deviation of its runs from the exact theory."""
    deviation = np.abs(np.asarray(values, dtype=float) / np.asarray(exact, dtype=float) - 1.0)
    deviation = deviation[np.isfinite(deviation)]
    if deviation.size == 0:
        return claim
    return replace(claim, exact_median=float(np.median(deviation)), exact_largest=float(deviation.max()))


@dataclass(frozen=True)
class Evidence:
    """What the ledger is computed from.

    Attributes
    ----------
    measured : per simulation, one row a run
    coarser : per simulation, the measured tables of the coarser lattices
    uncertainties : per simulation, the grid study of every number of every run
    settings : per claim, its tolerance and the reason for it
    """

    measured: Mapping[str, pd.DataFrame]
    coarser: Mapping[str, list[pd.DataFrame]]
    uncertainties: Mapping[str, pd.DataFrame]
    settings: Mapping[str, Mapping]

    def points(self, simulation: str, quantity: str, where: Callable | None = None) -> pd.DataFrame:
        """Runs of a sweep with the value and uncertainty of one quantity; flagged runs are left out."""
        study = self.uncertainties[simulation]
        study = study[study["quantity"] == quantity].set_index("point")
        table = self.measured[simulation].reset_index(drop=True)
        table = table.assign(
            value=study["value"].reindex(table.index),
            uncertainty=study["uncertainty"].reindex(table.index),
        )
        table = table[table["run_flags"].isna() | (table["run_flags"] == "")]
        return table[where(table)] if where is not None else table

    def tolerance(self, claim: str) -> float:
        """Tolerance of a claim, from the configuration."""
        return float(self.settings[claim]["tolerance"])

    def collapse(
        self,
        id: str,
        place: str,
        statement: str,
        points: pd.DataFrame,
        predicted: pd.Series | np.ndarray,
        source: str,
        caveat: bool = False,
        note: str = "",
    ) -> Claim:
        """A claim about every run of a sweep: the run that deviates most decides."""
        predicted = np.asarray(predicted, dtype=float)
        value, uncertainty = points["value"].to_numpy(float), points["uncertainty"].to_numpy(float)
        deviation = np.abs(value / predicted - 1.0)
        usable = np.isfinite(deviation) & np.isfinite(uncertainty)
        if not usable.any():
            return self.number(id, place, statement, NAN, NAN, NAN, source, note)
        worst = int(np.flatnonzero(usable)[np.argmax(deviation[usable])])
        claim = self.number(
            id, place, statement, predicted[worst], value[worst], uncertainty[worst], source, note, caveat
        )
        return replace(
            claim,
            runs=int(usable.sum()),
            left_out=int((~usable).sum()),
            median=float(np.median(deviation[usable])),
            largest=float(deviation[usable].max()),
        )

    def number(
        self,
        id: str,
        place: str,
        statement: str,
        predicted: float,
        measured: float,
        uncertainty: float,
        source: str,
        note: str = "",
        caveat: bool = False,
    ) -> Claim:
        """A claim about one number."""
        tolerance = self.tolerance(id)
        return Claim(
            id=id,
            figure_or_section=place,
            statement=statement,
            predicted=float(predicted),
            measured=float(measured),
            uncertainty=float(uncertainty),
            tolerance=tolerance,
            verdict=judge(float(predicted), float(measured), float(uncertainty), tolerance, caveat),
            note=note,
            source=source,
        )

    def share(
        self,
        id: str,
        place: str,
        statement: str,
        simulation: str,
        where: Callable[[pd.DataFrame], pd.Series],
        holds: Callable[[pd.DataFrame], pd.Series],
        source: str,
        note: str = "",
        caveat: bool = False,
    ) -> Claim:
        """A yes-or-no claim about many runs: the share of them for which it holds.

        Its uncertainty is how much that share changes on the coarser lattices.
        """
        shares = []
        for table in (self.measured[simulation], *self.coarser[simulation]):
            chosen = table[where(table)]
            shares.append(float(np.mean(holds(chosen))) if len(chosen) else float("nan"))
        uncertainty = max(abs(shares[0] - other) for other in shares[1:])
        claim = self.number(id, place, statement, 1.0, shares[0], uncertainty, source, note, caveat)
        return replace(claim, runs=int(where(self.measured[simulation]).sum()))
