"""Arrival angles from subspaces: angular innovations, fusion, projection and subspace fits."""
