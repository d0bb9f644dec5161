"""Bearing tracks: filters, start, existence and end, the stage that holds them."""
