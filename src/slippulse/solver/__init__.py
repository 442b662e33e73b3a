"""The lattice and the schemes that solve it.

Nothing here uses the theory, so agreement with the theory is evidence.
"""
