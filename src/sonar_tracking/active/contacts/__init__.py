"""What a ping says: checks, defaults, where its contacts and its sensor are."""
