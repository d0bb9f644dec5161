"""Passive chain: subspaces of an array, angular innovations, bearing tracks."""
