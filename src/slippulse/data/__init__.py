"""Files of data: how they are written and read, and what their variables mean."""
