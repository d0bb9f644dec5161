"""Where ships were, by the tables and logs of strangers."""
