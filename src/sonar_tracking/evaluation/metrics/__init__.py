"""Scores of tracks against the truth: OSPA, GOSPA, identities, errors."""
