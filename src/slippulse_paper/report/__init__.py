"""Write the report and the pages of results from tables and texts.

No number is typed into a text: each number comes from a table or from the configuration.
"""
