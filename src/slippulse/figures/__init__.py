"""Figures, one a module: `table` makes a figure's numbers from its NEEDS, `plot` draws them."""
