"""Study mismatch-bearings: the default bearing chain in scenes it was not tuned for."""
