"""Records of the jobs that wrote the results, provenance, and the lock of a run."""
