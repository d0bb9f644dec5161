"""Studies, metrics and reports: Monte Carlo over the layers below."""
