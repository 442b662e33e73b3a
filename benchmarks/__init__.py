"""Speed, measured: everything as ratios within one run, for any machine. Run by `make benchmark`."""
