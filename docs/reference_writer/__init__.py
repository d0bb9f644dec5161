"""The part of the documentation that is written from the code, as Markdown."""
