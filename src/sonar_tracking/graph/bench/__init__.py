"""Whole graphs measured from outside, as a user starts them."""
