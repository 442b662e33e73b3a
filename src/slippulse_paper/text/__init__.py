"""Conversion of numbers and Markdown to text for pages, and evaluation of templates."""
