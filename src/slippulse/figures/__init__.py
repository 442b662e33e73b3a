"""Figures: `table` makes the numbers that one draws of what its NEEDS name (`steps.inputs`), `plot` draws them."""
