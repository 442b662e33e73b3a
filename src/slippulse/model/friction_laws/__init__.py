"""Friction laws, one module for each family; `slippulse.model.friction` lists them by name."""
