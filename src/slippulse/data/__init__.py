"""Files of results: how they are written and read, joined from chunks, digested and recorded."""
