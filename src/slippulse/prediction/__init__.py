"""Predictions of the paper's formulas and of the exact theory for each run."""
