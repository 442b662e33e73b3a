"""Figures, one a module: `table` makes a table from its NEEDS, `draw` the figure from the table."""
