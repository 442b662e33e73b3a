"""The configuration: it is read and checked, expanded into scenes, and their cost is bounded."""
