"""World to sensors: scenarios, target motion, array snapshots."""
