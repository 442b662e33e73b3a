"""Claims of the paper, the numbers measured for each, and the verdicts computed from them."""
