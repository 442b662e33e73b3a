"""Figure 10: the transition under a displacement boundary for several damping ratios."""

from .shared.scaling import damping_figure, transition_table

draw, table = damping_figure, transition_table
NEEDS = {"measured": {"damping_displacement": ["transition"]}}
