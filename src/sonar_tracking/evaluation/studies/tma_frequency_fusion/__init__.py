"""Study tma-frequency-fusion: Cheong (2011)."""
