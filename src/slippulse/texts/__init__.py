"""How numbers are written and how texts with expressions are filled; knows nothing of what they are about."""
