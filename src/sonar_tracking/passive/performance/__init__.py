"""Bounds that no estimator of bearings can pass."""
