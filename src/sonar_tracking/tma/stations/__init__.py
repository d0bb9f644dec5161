"""Targets of several stations: which bearings are of one, and how stations are turned."""
