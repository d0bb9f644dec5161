"""Study detection-threshold: Jung and Shin (2002)."""
