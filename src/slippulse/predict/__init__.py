"""What the paper's formulas and the exact theory predict of a run."""
