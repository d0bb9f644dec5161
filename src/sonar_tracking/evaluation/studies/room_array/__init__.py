"""Study room-array: a recorded 32-element array in a room."""
