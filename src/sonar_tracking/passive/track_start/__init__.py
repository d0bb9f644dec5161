"""Where bearing tracks begin: new, hidden and faint sources."""
