"""Filters of the papers that keep a single hypothesis, beside which the default is measured."""
