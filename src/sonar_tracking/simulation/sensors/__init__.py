"""What sensors receive of a scenario: snapshots, samples, bearings, contacts, and the truth."""
