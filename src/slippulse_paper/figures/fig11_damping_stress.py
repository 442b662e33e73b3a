"""Figure 11: the transition under a stress boundary for several damping ratios."""

from .shared.scaling import damping_figure, transition_table

draw, table = damping_figure, transition_table
NEEDS = {"measured": {"damping_stress": ["transition"]}, "uncertainties": ["damping_stress"]}
# Runs of each simulation that the figure can draw, in the words of configuration/drawn.py.
DRAWS = {
    "damping_stress": "`boundary: stress`, left level < 0, right level 0, no steps",
}
