"""Write numbers as text, convert Markdown, and fill texts that are templates."""
