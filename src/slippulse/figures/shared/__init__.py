"""Parts that several figures share; a new figure takes what it needs.

A part has functions that return rows of a figure's table, which see data, and functions that draw,
which see rows of that table alone. Colours, sizes and legends stand in `figures.style`.
"""
