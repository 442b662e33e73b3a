"""The report and the pages of results, written from tables and texts.

No number is typed into a text: each one comes from a table or from the configuration.
"""
