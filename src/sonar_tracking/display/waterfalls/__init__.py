"""Rows of waterfalls: power and lines against time, on every time scale."""
