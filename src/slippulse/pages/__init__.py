"""HTML pages that load nothing from outside."""
