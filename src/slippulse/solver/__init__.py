"""How the lattice is advanced. Knows nothing of the theory, so that their agreement means something."""
