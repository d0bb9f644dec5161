"""Study scenario-seeds: the scenarios of the package, each with many seeds."""
