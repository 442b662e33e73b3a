"""Report and pages, written from tables and texts; no number in them is typed."""
