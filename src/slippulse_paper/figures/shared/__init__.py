"""Parts that several figures share: functions that make rows of tables and that draw them."""
