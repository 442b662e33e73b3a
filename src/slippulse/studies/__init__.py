"""Studies of the solver and of the theory: their designs as constants, and their tables."""
