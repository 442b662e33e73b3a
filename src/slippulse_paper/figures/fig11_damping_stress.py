"""Figure 11: the transition under a stress boundary for several damping ratios."""

from .shared.scaling import damping_figure, transition_table

draw, table = damping_figure, transition_table
NEEDS = {"measured": {"damping_stress": ["transition"]}}
