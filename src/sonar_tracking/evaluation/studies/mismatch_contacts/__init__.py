"""Study mismatch-contacts: the default contact tracker in scenes it was not tuned for."""
