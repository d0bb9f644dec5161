"""What ``sonar-tracking run``, ``replay`` and ``import`` do."""
