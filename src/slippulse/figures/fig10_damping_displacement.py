"""Figure 10: the transition under a displacement boundary for several damping ratios."""

from .shared.scaling import damping_figure as plot
from .shared.scaling import transition_table as table

__all__ = ["NEEDS", "plot", "table"]

NEEDS = {"measured": ["damping_displacement"], "predicted": {"damping_displacement": ["transition"]}}
