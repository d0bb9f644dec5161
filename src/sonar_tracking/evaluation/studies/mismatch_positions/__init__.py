"""Study mismatch-positions: the default position tracker in scenes it was not tuned for."""
