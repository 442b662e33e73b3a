"""Claims of the paper, the numbers that test them, and the verdicts computed from the numbers."""
