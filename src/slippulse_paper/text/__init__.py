"""Numbers as text, and texts that are templates."""
