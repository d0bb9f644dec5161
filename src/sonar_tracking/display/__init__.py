"""What people look at: track table and pictures."""
