"""Starts the nodes, drives the clock, watches, reports."""
