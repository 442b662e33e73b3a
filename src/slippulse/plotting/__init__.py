"""Pictures of runs, and the look of every figure."""
