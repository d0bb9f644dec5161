"""Frequency lines: from the samples of an array to tonals that are followed."""
