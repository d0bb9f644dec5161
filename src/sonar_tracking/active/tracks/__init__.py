"""Tracks as arrays: motion, gates, updates, birth and end."""
