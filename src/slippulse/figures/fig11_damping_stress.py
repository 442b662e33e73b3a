"""Figure 11: the transition under a stress boundary for several damping ratios."""

from __future__ import annotations

from collections.abc import Mapping

import pandas as pd
from matplotlib.figure import Figure

from .shared.scaling import damping_figure, transition_rows

NEEDS = {"measured": ["damping_stress"], "predicted": ["damping_stress"]}


def table(data: Mapping, tables: Mapping, settings: Mapping) -> pd.DataFrame:
    """Every run, as `transition_rows` has it."""
    return transition_rows(tables["damping_stress"])


def plot(table: pd.DataFrame) -> Figure:
    """Measured over predicted against the damping ratio: L_trans left, T_trans right."""
    return damping_figure(table)
