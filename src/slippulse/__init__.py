"""slippulse."""
