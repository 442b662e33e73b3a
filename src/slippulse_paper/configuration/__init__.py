"""The configuration: checked, expanded into scenes, and what they cost."""
