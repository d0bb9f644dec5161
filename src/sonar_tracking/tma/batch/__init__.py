"""Estimators that take a whole recording at once."""
