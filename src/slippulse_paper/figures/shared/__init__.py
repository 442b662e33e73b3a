"""Functions that several figures share: some make rows of a table, and others draw them."""
