"""Files, and what they are: writing and reading, chunks of a sweep, checksums, provenance."""
