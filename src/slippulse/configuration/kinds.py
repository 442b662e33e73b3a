"""Kinds of claims: what a sentence of the paper is, and with that which rule gives its verdict."""

KINDS = ("exact", "approximate", "qualitative", "reading", "arithmetic")
