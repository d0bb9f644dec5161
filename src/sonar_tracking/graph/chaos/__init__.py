"""Runs that are disturbed on purpose: what is killed, stopped or sent, and what comes of it."""
