"""Studies of the solver itself: each module's ``table(settings)`` is written to results/studies/NAME.csv."""
