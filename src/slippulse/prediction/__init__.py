"""Predictions for each run, by the formulas of the paper and by the exact theory.

Each module ``predicted_*`` has a function `predictions`, which returns a table with one row for
each run, and `LAWS`, the friction laws for which these rows are valid. `comparison` and
`measured_run` compare measured numbers with theory.
"""
