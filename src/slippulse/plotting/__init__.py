"""Pictures of single runs, and the style that all figures share."""
