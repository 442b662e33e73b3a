"""Studies of the solver and of the theory: their designs as constants, and their tables.

The sweeps in NEEDS are simulations whose parameters a study has.
"""
