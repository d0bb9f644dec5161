"""Records to messages; the other way is :mod:`sonar_tracking.message_reading`."""
