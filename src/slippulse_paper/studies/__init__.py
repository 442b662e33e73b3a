"""Studies of the solver and of the theory, one module for each.

A module has the design of its study as constants, and a function `table` that returns the result.
`NEEDS` lists the settings, data and sweeps of the configuration that the study uses.
"""
