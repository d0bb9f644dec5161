"""Bounds that no estimator of positions can pass."""
