"""Claims of the paper, with what was measured and the computed verdict."""
