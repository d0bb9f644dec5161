"""Shared estimation mathematics: Kalman filters and their consistency."""
