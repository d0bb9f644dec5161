"""Study maritime-contacts: recorded scans of a ferry's radar."""
