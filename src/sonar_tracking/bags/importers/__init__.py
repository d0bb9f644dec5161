"""Recorded data of others into bags."""
