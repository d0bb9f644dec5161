"""Study ship-bearings: a recorded ship heard by bottom-mounted arrays."""
