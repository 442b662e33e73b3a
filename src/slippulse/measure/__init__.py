"""From a run to numbers: fronts, pulses, transitions, regimes. No simulation, no drawing."""
