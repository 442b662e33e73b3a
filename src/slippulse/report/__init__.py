"""What people read: the replication report and the pages, from tables and texts; no number in them is typed."""
