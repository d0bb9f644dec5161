"""Files of sqlite3: read, and what can be had of damaged ones."""
