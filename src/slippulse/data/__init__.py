"""Data files: writing and reading them, and the meaning of their variables."""
