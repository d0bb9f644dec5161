"""What all nodes share: event time, stamps, parameters, quality of service, diagnostics."""
