"""Figure 11: the transition under a stress boundary for several damping ratios."""

from .shared.scaling import damping_figure as plot
from .shared.scaling import transition_table as table

__all__ = ["NEEDS", "plot", "table"]

NEEDS = {"measured": ["damping_stress"], "predicted": {"damping_stress": ["transition"]}}
