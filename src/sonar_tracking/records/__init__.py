"""What flows between the stages: plain arrays in frozen dataclasses, time, array types."""
