"""Predictions for each run, by the formulas of the paper and by the exact theory.

Each module ``predicted_*`` has a function `predictions`, which returns one row for each run, and
`LAWS`, the friction laws for which these rows hold. `comparison` and `measured_run` combine
measurements with the theory that belongs to them.
"""
