"""The replication report: every number in it comes from the results by name, none is typed."""
