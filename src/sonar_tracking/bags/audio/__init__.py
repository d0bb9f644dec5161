"""Audio files of recorders: what they hold, from when, and how far they agree with themselves."""
