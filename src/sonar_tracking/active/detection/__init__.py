"""Detection thresholds, probabilities of detection, clutter and amplitudes."""
