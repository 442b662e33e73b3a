"""The lattice and its schemes. They know nothing of the theory, so that agreement is evidence."""
