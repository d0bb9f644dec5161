"""The nodes: one file an executable, each a thin shell around a stage."""
