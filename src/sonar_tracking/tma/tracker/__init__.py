"""The tracker of positions: frames of all stations in, lists of targets and smoothed tracks out."""
