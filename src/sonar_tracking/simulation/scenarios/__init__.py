"""Scenarios: the world of a simulation, read from YAML."""
