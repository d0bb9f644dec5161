"""Targets together with the misalignment of the arrays that hear them.

What several stages share: a filter of the motion of targets and of how arrays are turned from what
their data tell, and what all targets tell together.
"""
