"""Recursive estimators of one target, the default and the published ones."""
