"""Numbers of a run: fronts, pulses, transitions, regimes. No simulation, no drawing."""
