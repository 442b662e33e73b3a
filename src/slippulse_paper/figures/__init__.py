"""Figures of the paper and beyond, one in each module.

The function `table` of a module makes a table of all drawn numbers from the data, tables and
settings that NEEDS lists. The function `draw` draws the figure from this table alone.
"""
