"""Figure 10: the transition under a displacement boundary for several damping ratios."""

from .shared.scaling import damping_figure, transition_table

draw, table = damping_figure, transition_table
NEEDS = {
    "measured": {"damping_displacement": ["transition"]},
    "uncertainties": ["damping_displacement"],
}
# Runs of each simulation that the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "damping_displacement": "`boundary: displacement` and equal levels > 0",
}
