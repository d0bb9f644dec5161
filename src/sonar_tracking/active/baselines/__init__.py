"""Published trackers to compare with: regions of interest, SMC-PHD."""
