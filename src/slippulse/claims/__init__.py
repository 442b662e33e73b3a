"""What the paper says, what was measured, and the verdict, computed."""
