"""Parts that several figures share; a new figure takes what it needs.

- `selection`: few of many levels, runs or points, evenly spread
- `numbers`: the main numbers of a run with their labels, beside exact theory
- `space_time`: a run over time and position
- `pulses`: pulses in the frame that moves with them
- `scaling`: length and time of the transition against the paper's formulas
- `sketch`: arrows and labels of a sketch

A part has functions that return rows of a figure's table, which see data, and functions that draw,
which see rows of that table alone. Colours, sizes and legends stand in `figures.style`.
"""
