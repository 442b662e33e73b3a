"""Parts that several figures share: rows of tables, made from data, and what draws these rows."""
