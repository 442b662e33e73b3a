"""Studies of the solver and of the theory.

Most modules are one study each. The constants of such a module are the parameters of the study, and
its function `table` returns the result. Its constant `NEEDS` lists the settings, data and sweeps
that the study uses. The other modules have functions that several studies share.
"""
