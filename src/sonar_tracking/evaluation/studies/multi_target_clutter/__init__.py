"""Study multi-target-clutter: Kim and Song (2007)."""
