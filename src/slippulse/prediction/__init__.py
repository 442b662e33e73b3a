"""Predictions for each run, by the formulas of the paper and by the exact theory.

Each module ``predicted_*`` has a function `predictions`, which returns a table with one row for
each run. These rows are valid for the friction laws in its constant `LAWS`. `comparison` and
`measured_run` compare measured numbers with theory.
"""
