"""The studies: one package each, and their catalogue."""
